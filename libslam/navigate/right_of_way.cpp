#include "libslam/navigate/right_of_way.h"

#include <algorithm>
#include <cmath>

#include "libslam/paths/free_space.h"
#include "libslam/paths/path_planner.h"

namespace slam::navigate {
namespace {

constexpr double kPatience_s = 1.0, kMorePatience_s = 2.5;  // the second for every place ahead of the last
constexpr double kPressed_m = 0.5, kPressed_s = 0.6;        // of who wants nothing: how near, how long
constexpr double kOffTheWay_m = 0.15;                       // between the discs, beside a known way
constexpr double kWaySight_m = 6.0;                         // of a known way, what is kept off
constexpr double kSearch_m = 7.0;
constexpr double kPast_m = 1.0;  // between the discs: the other one is past
constexpr double kLeastWait_s = 2.0;
constexpr double kWallMargin_m = 0.05;
constexpr double kSlowClearance_m = 0.15;

bool drives(const robot::Command& command) {
  return command.speed_mps != 0;
}

double distanceToLeg(const core::Point2& p, const core::Point2& a, const core::Point2& b) {
  const double dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
  const double s = length2 > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / length2, 0.0, 1.0) : 0;
  return core::distance(p, {a.x + s * dx, a.y + s * dy});
}

/// Of a place to the next metres of a neighbour's way.
double distanceToWay(const core::Point2& p, const NeighbourRobot& neighbour) {
  double least_m = core::distance(p, neighbour.p_map), along_m = 0;
  core::Point2 from = neighbour.p_map;
  for (const auto& to : neighbour.way) {
    least_m = std::min(least_m, distanceToLeg(p, from, to));
    along_m += core::distance(from, to);
    if (along_m > kWaySight_m) break;
    from = to;
  }
  return least_m;
}

/// The cells that a neighbour stands on are in the way.
void block(paths::FreeSpace& space, const core::Point2& p_map, double radius_m) {
  const int reach = static_cast<int>(std::ceil(radius_m / space.resolution_m));
  const int column = space.columnOf(p_map.x), row = space.rowOf(p_map.y);
  for (int r = row - reach; r <= row + reach; ++r)
    for (int c = column - reach; c <= column + reach; ++c)
      if (space.contains(c, r) && core::distance(space.centreOf(space.index(c, r)), p_map) < radius_m)
        space.state[space.index(c, r)] = paths::kOccupiedCell;
}

}  // namespace

RightOfWay::RightOfWay(const robot::RobotOptions& robot, double period_s, int number, int team)
    : robot_(robot),
      period_s_(period_s),
      patience_s_(kPatience_s + kMorePatience_s * (team - 1 - number)),
      number_(number) {}

bool RightOfWay::mayDo(const robot::Command& command, const core::Pose2& T_map_robot,
                       const std::vector<NeighbourRobot>& neighbours) const {
  if (!drives(command)) return true;
  const core::Point2 before = core::position(T_map_robot);
  const core::Point2 after = core::position(T_map_robot * robot::driveMotion(command));
  const double step_m = robot_.max_speed_mps * period_s_;
  for (const auto& neighbour : neighbours) {
    const double keep_m = contact_m() + kGap_m + step_m * (neighbour.number < number_ ? 2 : 1);
    const double then_m = core::distance(after, neighbour.p_map);
    if (then_m < keep_m && then_m <= core::distance(before, neighbour.p_map)) return false;
  }
  return true;
}

bool RightOfWay::isPressed(const core::Pose2& T_map_robot,
                           const std::vector<NeighbourRobot>& neighbours) const {
  const core::Point2 here = core::position(T_map_robot);
  return std::any_of(neighbours.begin(), neighbours.end(), [&](const NeighbourRobot& neighbour) {
    return neighbour.wants_to_drive && core::distance(here, neighbour.p_map) < contact_m() + kPressed_m;
  });
}

void RightOfWay::leave(const core::Pose2& T_map_robot, const std::vector<NeighbourRobot>& neighbours,
                       const gridmap::OccupancyRaster& map) {
  held_s_ = pressed_s_ = 0;
  paths::FreeSpace space = paths::readFreeSpace(map);
  paths::closeGaps(space);
  for (const auto& neighbour : neighbours) block(space, neighbour.p_map, contact_m() / 2);
  paths::PlannerOptions planning;
  planning.radius_m = robot::circumscribedRadius(robot_) + kWallMargin_m;
  planning.comfort_m = planning.radius_m;
  planning.tight_start = true;
  const core::Point2 here = core::position(T_map_robot);
  const paths::PathPlanner planner(space, planning, here);
  if (!planner.hasStart()) return;
  std::optional<paths::PathPlanner::Node> best;
  const int reach = static_cast<int>(kSearch_m / space.resolution_m);
  const int column = space.columnOf(here.x), row = space.rowOf(here.y);
  for (int r = std::max(0, row - reach); r <= std::min(space.rows - 1, row + reach); ++r)
    for (int c = std::max(0, column - reach); c <= std::min(space.columns - 1, column + reach); ++c) {
      const auto node = planner.nodeOf(space.index(c, r));
      if (!planner.isReached(node) || (best && planner.cost(node) >= planner.cost(*best))) continue;
      const core::Point2 p = planner.pointOf(node);
      const bool is_aside =
          std::all_of(neighbours.begin(), neighbours.end(), [&](const NeighbourRobot& other) {
            const bool is_far = core::distance(here, other.p_map) > kSearch_m;
            return is_far || (core::distance(p, other.p_map) > kAside_m &&
                              distanceToWay(p, other) > contact_m() + kOffTheWay_m);
          });
      if (is_aside) best = node;
    }
  if (!best) return;
  follower_.emplace(planner.shortened(planner.way(*best)), std::nullopt);
  away_s_ = 0;
}

/// Nothing: it is over.
std::optional<robot::Command> RightOfWay::giveWay(const lidar::Scan& scan, const core::Pose2& T_map_robot,
                                                  const std::vector<NeighbourRobot>& neighbours) {
  away_s_ += period_s_;
  if (follower_) {
    const auto step = follower_->next(scan, T_map_robot, robot_, kSlowClearance_m, period_s_);
    if (step.status == paths::PathFollower::Status::kFollowing && away_s_ < 2 * kLongest_s)
      return mayDo(step.command, T_map_robot, neighbours) ? step.command : stand();
    follower_.reset();
    waiting_ = true;
    away_s_ = 0;
  }
  const core::Point2 here = core::position(T_map_robot);
  const bool are_past = std::none_of(neighbours.begin(), neighbours.end(), [&](const NeighbourRobot& other) {
    return other.wants_to_drive && core::distance(here, other.p_map) < contact_m() + kPast_m;
  });
  if (away_s_ < kLongest_s && (away_s_ < kLeastWait_s || !are_past)) return stand();
  waiting_ = false;
  return std::nullopt;
}

RightOfWay::Answer RightOfWay::next(const std::optional<robot::Command>& wanted, const lidar::Scan& scan,
                                    const core::Pose2& T_map_robot,
                                    const std::vector<NeighbourRobot>& neighbours,
                                    const std::function<gridmap::OccupancyRaster()>& map) {
  if (givesWay()) {
    const auto command = giveWay(scan, T_map_robot, neighbours);
    return {command.value_or(stand()), !command};
  }
  const robot::Command command = wanted.value_or(stand());
  const bool is_allowed = mayDo(command, T_map_robot, neighbours);
  const bool wants_nothing = !drives(command) && command.turn_rate_radps == 0;
  held_s_ = is_allowed ? 0 : held_s_ + period_s_;
  pressed_s_ = wants_nothing && isPressed(T_map_robot, neighbours) ? pressed_s_ + period_s_ : 0;
  if (held_s_ >= patience_s_ || pressed_s_ >= kPressed_s) leave(T_map_robot, neighbours, map());
  return {is_allowed ? command : stand(), false};
}

}  // namespace slam::navigate
