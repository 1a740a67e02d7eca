#pragma once
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/navigate/strategy.h"
#include "libslam/table/table.h"

namespace slam::explore {

/// A decision when it was taken.
struct DecisionEntry {
  double time_s;
  core::Pose2 T_map_robot, T_world_robot;
  navigate::Decision decision;
};

/// Where it leads, map frame.
core::Point2 goalInMap(const DecisionEntry& entry);
/// All that is written of them is the same.
bool isSame(const navigate::Decision& a, const navigate::Decision& b);
/// A row for each.
table::Table decisionTable(const std::vector<DecisionEntry>& decisions);

}  // namespace slam::explore
