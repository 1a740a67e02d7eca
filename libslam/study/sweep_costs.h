#pragma once
#include <vector>

#include "libslam/report/table.h"
#include "libslam/sweep/cell.h"
#include "libslam/sweep/sweep_plan.h"

namespace slam::study {

/// Time and memory: differ from run to run. costs[i] is of plan.runs[i].
report::Table sweepCostTable(const sweep::SweepPlan& plan, const std::vector<sweep::CellCost>& costs);
/// The same as medians, one row per method.
report::Table sweepCostSummary(const sweep::SweepPlan& plan, const std::vector<sweep::CellCost>& costs);

}  // namespace slam::study
