#include "libslam/navigate/return_to_start.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "libslam/core/error.h"
#include "libslam/paths/path_planner.h"

namespace slam::navigate {
namespace {

choices::Decision finishedBecause(const std::string& reason) {
  choices::Decision decision;
  decision.finished = true;
  decision.reason = reason;
  return decision;
}

}  // namespace

choices::Decision ReturnToStart::decide(const lidar::Scan& /*scan*/, const core::Pose2& T_map_robot) {
  if (!space_) throw core::ContractError("ReturnToStart: decides by a map and was given none");
  if (core::distance(core::position(T_map_robot), core::Point2{}) <= kBackAtStart_m)
    return finishedBecause("back at the start");
  paths::FreeSpace driving = *space_;
  paths::closeGaps(driving);
  paths::PlannerOptions planning;
  planning.radius_m = robot::circumscribedRadius(robot_) + options_.plan_margin_m;
  planning.comfort_m = std::max(planning.radius_m, options_.comfort_m);
  planning.look_m = options_.look_m;
  const paths::PathPlanner planner(driving, planning, core::position(T_map_robot));
  const int column = driving.columnOf(0), row = driving.rowOf(0);
  if (!planner.hasStart() || !driving.contains(column, row))
    return finishedBecause("no way back to the start: the map calls no place near the robot free");
  auto node = planner.nodeOf(driving.index(column, row));
  // The start may be too near to a wall for the planner's margin: then as near as a look goes.
  if (const auto access = planner.accessOf(node)) node = *access;
  if (!planner.isReached(node)) return finishedBecause("no way back to the start by the map");
  const auto way = planner.way(node);
  choices::Decision decision;
  decision.path = planner.shortened(way);
  // A start in no node's middle: the last step leads to the very place when that is as good.
  if (!decision.path.empty() && core::distance(decision.path.back(), core::Point2{}) <= planning.node_m)
    decision.path.back() = core::Point2{};
  if (decision.path.empty() ||
      core::distance(decision.path.back(), core::position(T_map_robot)) < planning.node_m)
    return finishedBecause("as near to the start as the map allows");
  decision.goal = decision.path.back();
  decision.score = -planner.cost(node);
  char reason[60];
  std::snprintf(reason, sizeof reason, "back to the start: %.1f m of way", planner.length(way));
  decision.reason = reason;
  return decision;
}

}  // namespace slam::navigate
