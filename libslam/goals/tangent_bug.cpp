#include "libslam/goals/tangent_bug.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libslam/core/elementary.h"

namespace slam::goals {
namespace {

constexpr int kDirections = 360;
constexpr double kDegree_rad = 2 * core::kPi / kDirections;
// A step between neighbouring directions that is an edge and not the slant of one wall.
constexpr double kEdge_m = 0.3;
constexpr double kProgress_m = 0.2;
// A node nearer to the goal by less than noise makes of it is none.
constexpr double kNodeProgress_m = 0.02;
// A node is worth changing to when it saves this much.
constexpr double kBetter_m = 0.3;

double directionOf(int k) {
  return -core::kPi + k * kDegree_rad;
}

core::Point2 along(double direction_rad, double distance_m) {
  return core::polar(distance_m, direction_rad);
}

}  // namespace

TangentBug::TangentBug(const NavigateOptions& options, const GoalTask& task)
    : GuardedNavigator(options, task), follower_(options.turn == "left", options.boundary_tolerance_m) {}

GoalStep TangentBug::step(const robot::Command& command, GoalStatus status) const {
  static constexpr const char* kNames[] = {"to goal", "along the boundary", "to the leave node"};
  return {command, status,
          status == GoalStatus::kMoving ? kNames[static_cast<int>(state_)] : statusName(status), reason_};
}

bool TangentBug::isSeen(const lidar::Scan& scan, double direction_rad) const {
  if (scan.isFullCircle()) return true;
  const double last_rad = scan.angle(scan.ranges_m.size() - 1);
  const double middle_rad = scan.T_robot_lidar.phi + 0.5 * (scan.first_angle_rad + last_rad);
  return std::abs(core::angleDifference(direction_rad, middle_rad)) <=
         0.5 * (last_rad - scan.first_angle_rad) + 0.5 * scan.step_rad;
}

void TangentBug::look(const lidar::Scan& scan) {
  const double sensor_m =
      options_.sensor_range_m > 0 ? std::min(options_.sensor_range_m, scan.max_range_m) : scan.max_range_m;
  // At the end of the range half of the disc would stand where the lidar does not see.
  range_m_ = std::max(sensor_m - surroundings_.followRadius(), surroundings_.step_m());
  // A disc that something already touches could go nowhere: then the largest that fits.
  const double radius_m =
      std::clamp(surroundings_.nearest_m() - 1e-3, surroundings_.guardRadius(), surroundings_.followRadius());
  free_m_.assign(kDirections, std::numeric_limits<double>::quiet_NaN());
  for (int k = 0; k < kDirections; ++k)
    if (isSeen(scan, directionOf(k)))
      free_m_[k] = std::min(range_m_, surroundings_.way(directionOf(k), radius_m).free_m);
}

std::vector<TangentBug::Node> TangentBug::nodes(const core::Pose2& T_odom_robot) const {
  const core::Point2 p_robot_goal = core::inverse(T_odom_robot) * task_.p_odom_goal;
  std::vector<Node> nodes;
  for (int k = 0; k < kDirections; ++k) {
    const int next = (k + 1) % kDirections;
    if (std::isnan(free_m_[k]) || std::isnan(free_m_[next])) continue;
    const double near_m = std::min(free_m_[k], free_m_[next]);
    const bool is_edge = std::abs(free_m_[k] - free_m_[next]) > kEdge_m ||
                         (free_m_[k] < range_m_) != (free_m_[next] < range_m_);
    if (!is_edge) continue;
    // The place beside the nearer thing, on the way that passes it.
    const int open = free_m_[k] > free_m_[next] ? k : next;
    const double reach_m = std::min(std::max(near_m, surroundings_.step_m()), free_m_[open]);
    if (reach_m < surroundings_.step_m()) continue;
    const core::Point2 p_robot = along(directionOf(open), reach_m);
    const double goal_m = core::distance(p_robot, p_robot_goal);
    nodes.push_back({p_robot, goal_m, reach_m + goal_m});
  }
  return nodes;
}

std::optional<core::Point2> TangentBug::headingTo(const core::Pose2& T_odom_robot) const {
  if (!p_odom_heading_to_) return std::nullopt;
  const core::Point2 p_robot = core::inverse(T_odom_robot) * *p_odom_heading_to_;
  const double rest_m = core::hypot(p_robot.x, p_robot.y);
  const double node_goal_m = core::distance(*p_odom_heading_to_, task_.p_odom_goal);
  const double free_m =
      surroundings_.way(core::atan2(p_robot.y, p_robot.x), surroundings_.guardRadius()).free_m;
  if (rest_m > surroundings_.step_m() && free_m >= rest_m && node_goal_m < goalDistance(T_odom_robot))
    return p_robot;
  return std::nullopt;
}

std::optional<core::Point2> TangentBug::chooseNode(const std::vector<Node>& all,
                                                   const core::Pose2& T_odom_robot) const {
  const double goal_m = goalDistance(T_odom_robot);
  std::optional<core::Point2> best;
  double least_m = std::numeric_limits<double>::infinity();
  // The node chosen before stays while it can be driven to: noise makes nodes come and go, and a lidar with a
  // blind sector sees others after every turn.
  if (const auto p_robot = headingTo(T_odom_robot)) {
    best = p_robot;
    least_m = core::hypot(p_robot->x, p_robot->y) + core::distance(*p_odom_heading_to_, task_.p_odom_goal) -
              kBetter_m;
  }
  for (const auto& node : all)
    if (node.goal_m < goal_m - kNodeProgress_m && node.cost_m < least_m)
      best = node.p_robot, least_m = node.cost_m;
  return best;
}

GoalStep TangentBug::plan(const lidar::Scan& scan, const core::Pose2& T_odom_robot) {
  switch (state_) {
    case State::kToGoal:
      return toGoal(scan, T_odom_robot);
    case State::kBoundary:
      return follow(scan, T_odom_robot);
    case State::kTransition:
      break;
  }
  return transition(T_odom_robot);
}

GoalStep TangentBug::driveTo(const core::Point2& p_robot) const {
  return step(surroundings_.towards(core::atan2(p_robot.y, p_robot.x), core::hypot(p_robot.x, p_robot.y)));
}

GoalStep TangentBug::toGoal(const lidar::Scan& scan, const core::Pose2& T_odom_robot) {
  look(scan);
  const double goal_rad = goalDirection(T_odom_robot), goal_m = goalDistance(T_odom_robot);
  const double free_m = freeToGoal(T_odom_robot);
  const bool is_open = free_m >= std::min(goal_m, range_m_), is_seen = isSeen(scan, goal_rad);
  // What the lidar does not look at is not known to be free, but it may be known to be blocked: a turn to a
  // node takes the goal out of a narrow view.
  if (is_open) {
    p_odom_heading_to_.reset();
    return step(is_seen ? surroundings_.towards(goal_rad, goal_m) : surroundings_.turn(goal_rad));
  }
  const auto all = nodes(T_odom_robot);
  if (const auto p_robot = chooseNode(all, T_odom_robot)) {
    p_odom_heading_to_ = T_odom_robot * *p_robot;
    return driveTo(*p_robot);
  }
  p_odom_heading_to_.reset();
  if (!is_seen) return step(surroundings_.turn(goal_rad));
  if (free_m >= surroundings_.step_m()) return step(surroundings_.towards(goal_rad, free_m));

  state_ = State::kBoundary;
  reason_ = "local minimum at " + describe(core::position(T_odom_robot));
  nearest_goal_m_ = goal_m;
  needed_progress_m_ = kProgress_m;
  bool wall_on_right = options_.turn == "left";
  double least_m = std::numeric_limits<double>::infinity();
  for (const auto& node : all) {
    if (node.cost_m >= least_m) continue;
    least_m = node.cost_m;
    wall_on_right = core::angleDifference(core::atan2(node.p_robot.y, node.p_robot.x), goal_rad) > 0;
  }
  follower_ = BoundaryFollower(wall_on_right, options_.boundary_tolerance_m);
  follower_.begin(surroundings_, T_odom_robot, goal_rad);
  return follow(scan, T_odom_robot);
}

std::optional<core::Point2> TangentBug::visiblePlaceNearerThan(double goal_m,
                                                               const core::Pose2& T_odom_robot) const {
  const core::Point2 p_robot_goal = core::inverse(T_odom_robot) * task_.p_odom_goal;
  std::optional<core::Point2> best;
  for (int k = 0; k < kDirections; ++k) {
    if (std::isnan(free_m_[k])) continue;
    const core::Point2 unit = along(directionOf(k), 1);
    const double foot_m = unit.x * p_robot_goal.x + unit.y * p_robot_goal.y;
    const core::Point2 place = along(directionOf(k), std::clamp(foot_m, 0.0, free_m_[k]));
    const double place_goal_m = core::distance(place, p_robot_goal);
    if (place_goal_m < goal_m) goal_m = place_goal_m, best = place;
  }
  return best;
}

GoalStep TangentBug::follow(const lidar::Scan& scan, const core::Pose2& T_odom_robot) {
  look(scan);
  switch (follower_.update(surroundings_, T_odom_robot)) {
    case BoundaryFollower::Result::kBoxedIn:
      reason_ = "boxed in: the disc fits nowhere from here";
      return step(surroundings_.stand(), GoalStatus::kUnreachable);
    case BoundaryFollower::Result::kWallLost:
      state_ = State::kToGoal;
      reason_ = "the obstacle is gone";
      return step(surroundings_.stand());
    case BoundaryFollower::Result::kFollowing:
      break;
  }
  nearest_goal_m_ = std::min(nearest_goal_m_, goalDistance(T_odom_robot));
  if (const auto place = visiblePlaceNearerThan(nearest_goal_m_ - needed_progress_m_, T_odom_robot)) {
    state_ = State::kTransition;
    p_odom_place_ = T_odom_robot * *place;
    reason_ = "sees a place nearer to the goal: " + describe(p_odom_place_);
    return transition(T_odom_robot);
  }
  if (follower_.closed()) {
    reason_ = "been round the boundary without seeing a place nearer to the goal";
    return step(surroundings_.stand(), GoalStatus::kUnreachable);
  }
  return step(surroundings_.towards(follower_.direction(), surroundings_.step_m()));
}

GoalStep TangentBug::transition(const core::Pose2& T_odom_robot) {
  const core::Point2 p_robot = core::inverse(T_odom_robot) * p_odom_place_;
  const double direction_rad = core::atan2(p_robot.y, p_robot.x), rest_m = core::hypot(p_robot.x, p_robot.y);
  const bool nearer = goalDistance(T_odom_robot) < nearest_goal_m_ - 0.5 * needed_progress_m_;
  const bool blocked = surroundings_.way(direction_rad, surroundings_.guardRadius()).free_m <
                       std::min(rest_m, 0.5 * surroundings_.step_m());
  if (nearer || rest_m < 0.05) {
    state_ = State::kToGoal;
    reason_ = "nearer to the goal than the boundary was, at " + describe(core::position(T_odom_robot));
  } else if (blocked) {
    state_ = State::kBoundary;
    reason_ = "the way to the leave node is blocked";
    // What looked like a way was none: the next one has to promise more, so this ends.
    needed_progress_m_ += kProgress_m;
    follower_.begin(surroundings_, T_odom_robot, direction_rad);
    return step(surroundings_.stand());
  }
  return step(surroundings_.towards(direction_rad, rest_m));
}

}  // namespace slam::goals
