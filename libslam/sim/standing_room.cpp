#include "libslam/sim/standing_room.h"

#include <cmath>
#include <cstdio>

#include "libslam/core/error.h"

namespace slam::sim {
namespace {

std::string describe(const core::Pose2& pose) {
  char text[100];
  std::snprintf(text, sizeof text, "(%.3f m, %.3f m, %.1f deg)", pose.x, pose.y, core::radToDeg(pose.phi));
  return text;
}

}  // namespace

std::string refusalOf(const world::Plan& plan, const core::Pose2& T_world_robot, double radius_m) {
  if (!core::isFinite(T_world_robot)) return "not finite";
  const core::Point2 cell = world::pointToCells(plan, core::position(T_world_robot));
  const double column = std::floor(cell.x), row = std::floor(cell.y);
  if (!(column >= 0 && row >= 0 && column < plan.columns && row < plan.rows)) return "outside the plan";
  if (plan.at(static_cast<int>(column), static_cast<int>(row)) == world::Cell::kOccupied) return "in a wall";
  if (world::discCollides(plan, core::position(T_world_robot), radius_m)) return "too near to a wall";
  return "";
}

void requireStandingRoom(const world::Plan& plan, const std::string& what, const core::Pose2& T_world_robot,
                         double radius_m) {
  const std::string found = refusalOf(plan, T_world_robot, radius_m);
  if (found.empty()) return;
  char needed[100];
  std::snprintf(needed, sizeof needed, ", expected a clearance of %.3f m all round", radius_m);
  throw core::InputError("plan '" + plan.name + "': " + what + " " + describe(T_world_robot) + " is " +
                         found + needed);
}

}  // namespace slam::sim
