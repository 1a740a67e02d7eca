#pragma once
#include "libslam/goals/boundary_follower.h"
#include "libslam/goals/guarded_navigator.h"

namespace slam::goals {

/// Bug1 (Lumelsky and Stepanov, "Path-planning strategies for a point mobile automaton moving amidst unknown
/// obstacles of arbitrary shape", Algorithmica 2, 1987), for a disc: drive to the goal; at an obstacle go all
/// the way round it, then by the shorter way back to the place nearest to the goal, and leave there. If the
/// way to the goal is blocked at that place, the goal cannot be reached.
///
/// Path at most D + 1.5 * sum of p_i (their theorem): D the distance from start to goal, p_i the perimeters
/// of the obstacles, here of those grown by the disc, that lie nearer to the goal than the start.
class Bug1 : public GuardedNavigator {
 public:
  Bug1(const NavigateOptions& options, const GoalTask& task);

 private:
  enum class State { kToGoal, kRound, kToLeavePoint };
  GoalStep plan(const lidar::Scan& scan, const core::Pose2& T_odom_robot) override;
  GoalStep toGoal(const core::Pose2& T_odom_robot);
  GoalStep goRound(const core::Pose2& T_odom_robot);
  GoalStep toLeavePoint(const core::Pose2& T_odom_robot);
  GoalStep leave(const core::Pose2& T_odom_robot);
  GoalStep step(const robot::Command& command, GoalStatus status = GoalStatus::kMoving) const;

  State state_ = State::kToGoal;
  std::string reason_ = "start";
  BoundaryFollower follower_;
  /// The nearest place to the goal on this boundary.
  struct Nearest {
    double goal_m = 0, at_length_m = 0, bearing_rad = 0;
    core::Pose2 T_odom;
  } nearest_;
  double lost_beyond_m_ = 0;  ///< length followed at which the leave point was missed
};

}  // namespace slam::goals
