#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "libslam/sweep/sweep_plan.h"
#include "libslam/table/table.h"

namespace slam::summary {

// The rows of a sweep's tables: which runs belong together.

/// An axis of a sweep, and what a log has on it.
struct SweepAxis {
  const char* key;
  std::string sweep::PlannedLog::*member;
};
const std::vector<SweepAxis>& sweepAxes();
/// Those on which the logs of the sweep differ.
std::vector<SweepAxis> varyingAxes(const sweep::SweepPlan& plan);

/// "graph", or "graph graph.keyframe_m=0.5".
std::string fullName(const sweep::PlannedRun& run);
/// Of all runs, in the order of the plan.
std::vector<std::string> methodNames(const sweep::SweepPlan& plan);

/// What a log has on all axes: one setting, with any seed.
std::string settingKey(const sweep::PlannedLog& log);
/// For MeanOptions::strata and its like: of each run (indices) the number of its setting, which is everything
/// but method and seed. None where no setting has two of the runs: then settings are what is drawn.
std::vector<std::size_t> settingsOf(const sweep::SweepPlan& plan, const std::vector<std::size_t>& runs);

/// The runs of one setting, which differ in seed and method only; or of all settings together.
struct SweepGroup {
  const sweep::PlannedLog* log = nullptr;         ///< nullptr: all together
  std::vector<std::vector<std::size_t>> methods;  ///< by method, its runs in the order of the plan
  std::vector<std::size_t> settings = {};         ///< of each of these, of all together; else none
};
/// All together first, where there are several settings, then the settings in the order of the plan; methods
/// as `names`.
std::vector<SweepGroup> groupsOf(const sweep::SweepPlan& plan, const std::vector<std::string>& names);

/// What stands in a row for these axes: the group's place on each, or "all".
std::vector<table::CellValue> axisCells(const SweepGroup& group, const std::vector<SweepAxis>& axes);

}  // namespace slam::summary
