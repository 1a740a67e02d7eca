#pragma once
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "libslam/stats/paired.h"
#include "libslam/stats/proportion.h"
#include "libslam/summary/run_figures.h"
#include "libslam/summary/sweep_groups.h"
#include "libslam/sweep/sweep_plan.h"

namespace slam::summary {

/// What the runs of one group say of one method.
struct MethodStatistics {
  std::size_t runs = 0, failed = 0;
  stats::Interval failure_rate;
  std::vector<stats::Estimate> figures;  ///< medians of summaryKeys(); NaN where there is none
  std::string letters = "-";             ///< of the groups that cannot be told apart
  /// Against the baseline.
  stats::Estimate better{std::numeric_limits<double>::quiet_NaN(), std::nullopt};
  double p = std::numeric_limits<double>::quiet_NaN(), adjusted_p = std::numeric_limits<double>::quiet_NaN();
  std::string more_seeds;
};

/// The numbers of a sweep's summary, group by group (SweepSummary says what they are).
class SweepStatistics {
 public:
  /// Both must live as long.
  SweepStatistics(const sweep::SweepPlan& plan, const SweepResults& results);

  const std::vector<std::string>& keys() const { return keys_; }    ///< summaryKeys()
  const std::vector<std::string>& names() const { return names_; }  ///< methodNames()
  std::vector<SweepGroup> groups() const { return groupsOf(plan_, names_); }
  /// By method, as names().
  std::vector<MethodStatistics> of(const SweepGroup& group) const;

 private:
  MethodStatistics alone(const std::vector<std::size_t>& runs,
                         const std::vector<std::size_t>& settings) const;
  void compare(const SweepGroup& group, std::vector<MethodStatistics>& methods) const;

  const sweep::SweepPlan& plan_;
  const SweepResults& results_;
  std::vector<std::string> keys_, names_;
  stats::Better better_;
  std::size_t baseline_ = 0;
};

}  // namespace slam::summary
