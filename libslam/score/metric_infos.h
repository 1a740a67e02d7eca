#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libslam/score/evaluate.h"
#include "libslam/stats/paired.h"

namespace slam::score {

/// One metric: the row that feeds every table and `rasterslam list metrics`.
struct MetricInfo {
  std::string key, title, meaning;
  int decimals;
  double (*of)(const Evaluation&);
  std::optional<stats::Better> better = stats::Better::kSmaller;  ///< none: neither direction is good
  bool depends_on_machine = false;  ///< time and memory: not the same bytes twice
};
const std::vector<MetricInfo>& metricInfos();
/// Keys of those that differ from run to run: time and memory.
const std::vector<std::string>& costKeys();

}  // namespace slam::score
