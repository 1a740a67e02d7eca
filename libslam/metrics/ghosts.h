#pragma once
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/metrics/map_score.h"
#include "libslam/world/plan.h"

namespace slam::metrics {

/// How far around a person's place the lidar may see it: its legs, or its disc.
inline constexpr double kPersonReach_m = 0.35;

/// What people leave behind in a map: the share of the ground that they were on which the map calls occupied.
/// That ground are the seen free cells of the plan whose centre lies within kPersonReach_m of a place where
/// somebody was (`people`, world frame), and beyond tolerance_m of the centre of every wall of the plan, for
/// a wall that is drawn a little off is no ghost. Occupied on it are the cells of the map whose centre lies
/// in such a cell; both are areas, 0 to 1. NaN without such ground, or where T_world_map is not finite.
/// REQUIRES a mask of the plan's size, tolerance_m >= 0 (ContractError). `map` and T_world_map as scoreMap()
/// has them.
double ghostShare(const world::Plan& plan, const SeenMask& seen, const std::vector<core::Point2>& people,
                  const world::CellMap& map, const core::Pose2& T_world_map, double tolerance_m);

}  // namespace slam::metrics
