#include "libslam/goals/bug2.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"

namespace slam::goals {
namespace {

// Nearer than this to the hit point, noise could make the same place look like progress.
constexpr double kProgress_m = 0.1;
constexpr double kOnLine_m = 0.03;

}  // namespace

Bug2::Bug2(const NavigateOptions& options, const GoalTask& task)
    : GuardedNavigator(options, task), follower_(options.turn == "left", options.boundary_tolerance_m) {}

GoalStep Bug2::step(const robot::Command& command, GoalStatus status) const {
  const char* name = following_ ? "along the boundary" : "to goal";
  return {command, status, status == GoalStatus::kMoving ? name : statusName(status), reason_};
}

double Bug2::offLine(const core::Pose2& T_odom_robot) const {
  const double dx = task_.p_odom_goal.x - T_odom_start_->x, dy = task_.p_odom_goal.y - T_odom_start_->y;
  const double length_m = core::hypot(dx, dy);
  return (dx * (T_odom_robot.y - T_odom_start_->y) - dy * (T_odom_robot.x - T_odom_start_->x)) / length_m;
}

GoalStep Bug2::plan(const lidar::Scan& /*scan*/, const core::Pose2& T_odom_robot) {
  if (!T_odom_start_) T_odom_start_ = T_odom_robot;
  return following_ ? follow(T_odom_robot) : toGoal(T_odom_robot);
}

GoalStep Bug2::toGoal(const core::Pose2& T_odom_robot) {
  const double free_m = freeToGoal(T_odom_robot);
  if (free_m >= std::min(surroundings_.step_m(), goalDistance(T_odom_robot)))
    return step(surroundings_.towards(goalDirection(T_odom_robot), free_m));
  following_ = true;
  reason_ = "hit an obstacle at " + describe(core::position(T_odom_robot));
  hit_goal_m_ = goalDistance(T_odom_robot);
  last_off_m_ = offLine(T_odom_robot);
  follower_ = BoundaryFollower(options_.turn == "left", options_.boundary_tolerance_m);
  follower_.begin(surroundings_, T_odom_robot, goalDirection(T_odom_robot));
  return follow(T_odom_robot);
}

GoalStep Bug2::follow(const core::Pose2& T_odom_robot) {
  switch (follower_.update(surroundings_, T_odom_robot)) {
    case BoundaryFollower::Result::kBoxedIn:
      reason_ = "boxed in: the disc fits nowhere from here";
      return step(surroundings_.stand(), GoalStatus::kUnreachable);
    case BoundaryFollower::Result::kWallLost:
      following_ = false;
      reason_ = "the obstacle is gone";
      return step(surroundings_.stand());
    case BoundaryFollower::Result::kFollowing:
      break;
  }
  const double off_m = offLine(T_odom_robot);
  const bool on_line = off_m * last_off_m_ < 0 || std::abs(off_m) < kOnLine_m;
  last_off_m_ = off_m;
  const double goal_m = goalDistance(T_odom_robot);
  const double needed_m = std::min(2 * surroundings_.step_m(), goal_m);
  if (on_line && goal_m < hit_goal_m_ - kProgress_m && freeToGoal(T_odom_robot) >= needed_m) {
    following_ = false;
    reason_ = "met the line again at " + describe(core::position(T_odom_robot));
    return step(surroundings_.towards(goalDirection(T_odom_robot), needed_m));
  }
  if (follower_.closed()) {
    reason_ = "back at the hit point without meeting the line nearer to the goal";
    return step(surroundings_.stand(), GoalStatus::kUnreachable);
  }
  return step(surroundings_.towards(follower_.direction(), surroundings_.step_m()));
}

}  // namespace slam::goals
