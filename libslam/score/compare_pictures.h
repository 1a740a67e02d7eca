#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/progress.h"
#include "libslam/results/run_folder.h"
#include "libslam/score/evaluate.h"

namespace slam::score {

/// maps.png, paths.png and scan.png of a comparison, and in each run's folder its difference from the plan,
/// where that is known.
void drawPictures(const std::vector<results::RunFolder>& runs, const std::vector<Evaluation>& evaluations,
                  const std::optional<Truth>& truth, const std::string& log_path, const std::string& output,
                  core::Progress& progress);

}  // namespace slam::score
