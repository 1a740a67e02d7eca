#pragma once
#include "libslam/summary/sweep_tables.h"
#include "libslam/sweep/sweep_plan.h"
#include "libslam/table/table.h"

namespace slam::summary {

/// What a terminal has room for of a sweep's summary.
struct SweepBrief {
  /// The rows of all settings together, without the axes; where there is a single setting the whole summary.
  table::Table overall;
  /// One row per method: the setting with the highest failure rate, of equals that with the worst metric. No
  /// rows where there is a single setting. A setting without a run of the method does not count.
  table::Table worst;
};

/// REQUIRES the summary of this plan's results.
SweepBrief briefOf(const sweep::SweepPlan& plan, const SweepSummary& summary);

}  // namespace slam::summary
