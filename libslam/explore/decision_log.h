#pragma once
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/strategies/strategy.h"
#include "libslam/table/table.h"

namespace slam::explore {

/// A decision when it was taken.
struct DecisionEntry {
  double time_s;
  core::Pose2 T_map_robot, T_world_robot;
  choices::Decision decision;
};

/// Where it leads, map frame.
core::Point2 goalInMap(const DecisionEntry& entry);
/// All that is written of them is the same.
bool isSame(const choices::Decision& a, const choices::Decision& b);
/// A row for each.
table::Table decisionTable(const std::vector<DecisionEntry>& decisions);

}  // namespace slam::explore
