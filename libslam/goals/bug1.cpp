#include "libslam/goals/bug1.h"

#include <algorithm>
#include <limits>

namespace slam::goals {

Bug1::Bug1(const NavigateOptions& options, const GoalTask& task)
    : GuardedNavigator(options, task), follower_(options.turn == "left", options.boundary_tolerance_m) {}

GoalStep Bug1::step(const robot::Command& command, GoalStatus status) const {
  static constexpr const char* kNames[] = {"to goal", "round the obstacle", "to the leave point"};
  return {command, status,
          status == GoalStatus::kMoving ? kNames[static_cast<int>(state_)] : statusName(status), reason_};
}

GoalStep Bug1::plan(const lidar::Scan& /*scan*/, const core::Pose2& T_odom_robot) {
  switch (state_) {
    case State::kToGoal:
      return toGoal(T_odom_robot);
    case State::kRound:
      return goRound(T_odom_robot);
    case State::kToLeavePoint:
      break;
  }
  return toLeavePoint(T_odom_robot);
}

GoalStep Bug1::toGoal(const core::Pose2& T_odom_robot) {
  const double free_m = freeToGoal(T_odom_robot);
  if (free_m >= std::min(surroundings_.step_m(), goalDistance(T_odom_robot)))
    return step(surroundings_.towards(goalDirection(T_odom_robot), free_m));
  state_ = State::kRound;
  reason_ = "hit an obstacle at " + describe(core::position(T_odom_robot));
  follower_ = BoundaryFollower(options_.turn == "left", options_.boundary_tolerance_m);
  follower_.begin(surroundings_, T_odom_robot, goalDirection(T_odom_robot));
  nearest_ = {};
  nearest_.goal_m = std::numeric_limits<double>::infinity();
  return goRound(T_odom_robot);
}

GoalStep Bug1::goRound(const core::Pose2& T_odom_robot) {
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
  if (goalDistance(T_odom_robot) < nearest_.goal_m)
    nearest_ = {goalDistance(T_odom_robot), follower_.length_m(), follower_.contactBearing(), T_odom_robot};
  if (!follower_.closed()) return step(surroundings_.towards(follower_.direction(), surroundings_.step_m()));
  const double round_m = follower_.length_m();
  state_ = State::kToLeavePoint;
  reason_ = "been round it; nearest to the goal at " + describe(core::position(nearest_.T_odom));
  const bool shorter_back = nearest_.at_length_m > 0.5 * round_m;
  if (shorter_back) follower_.reverse(T_odom_robot);
  // A whole round more without finding the place means that the pose is lost.
  lost_beyond_m_ = (shorter_back ? 1 : 2) * round_m + 1;
  return toLeavePoint(T_odom_robot);
}

GoalStep Bug1::toLeavePoint(const core::Pose2& T_odom_robot) {
  if (follower_.update(surroundings_, T_odom_robot) != BoundaryFollower::Result::kFollowing) {
    reason_ = "lost the boundary on the way back";
    return step(surroundings_.stand(), GoalStatus::kGaveUp);
  }
  if (follower_.isAt(nearest_.T_odom, nearest_.bearing_rad)) return leave(T_odom_robot);
  if (follower_.length_m() > lost_beyond_m_) {
    reason_ = "did not find the leave point again: the pose has drifted";
    return step(surroundings_.stand(), GoalStatus::kGaveUp);
  }
  return step(surroundings_.towards(follower_.direction(), surroundings_.step_m()));
}

GoalStep Bug1::leave(const core::Pose2& T_odom_robot) {
  const double free_m = freeToGoal(T_odom_robot);
  if (free_m < std::min(surroundings_.step_m(), goalDistance(T_odom_robot))) {
    reason_ = "the way to the goal is blocked where the obstacle comes nearest to it";
    return step(surroundings_.stand(), GoalStatus::kUnreachable);
  }
  state_ = State::kToGoal;
  reason_ = "leave at " + describe(core::position(T_odom_robot));
  return step(surroundings_.towards(goalDirection(T_odom_robot), free_m));
}

}  // namespace slam::goals
