#pragma once
#include <vector>

#include "libslam/sweep/cell.h"
#include "libslam/sweep/sweep_plan.h"
#include "libslam/table/table.h"

namespace slam::summary {

/// Time and memory: differ from run to run. costs[i] is of plan.runs[i].
table::Table sweepCostTable(const sweep::SweepPlan& plan, const std::vector<sweep::CellCost>& costs);
/// The same as medians, one row per method.
table::Table sweepCostSummary(const sweep::SweepPlan& plan, const std::vector<sweep::CellCost>& costs);

}  // namespace slam::summary
