#pragma once
#include <string>

#include "libslam/summary/run_figures.h"
#include "libslam/sweep/sweep_plan.h"
#include "libslam/table/table.h"

namespace slam::summary {

/// Where and why the runs of a sweep failed: one row per run that failed (isFailed()) or was at some time
/// farther off than FailureLimits::drift_m (ate_max_m), with what its cell in `folder` says of it
/// (failure.json). A run that left no path has only its status and message. The same bytes for the same
/// cells.
struct SweepFailures {
  table::Table main;  ///< for people: what, where, suspect
  table::Table all;
};
SweepFailures sweepFailures(const sweep::SweepPlan& plan, const SweepResults& results,
                            const std::string& folder);

}  // namespace slam::summary
