#pragma once
#include <optional>

#include "libslam/goals/boundary_follower.h"
#include "libslam/goals/guarded_navigator.h"

namespace slam::goals {

/// Bug2 (Lumelsky and Stepanov, Algorithmica 2, 1987), for a disc: drive along the line from start to goal;
/// at an obstacle follow its boundary until the line is met again nearer to the goal than at the hit and the
/// way on is free. Back at the hit without that, the goal cannot be reached.
///
/// Path at most D + sum of n_i * p_i / 2 (their theorem): n_i how often the line crosses the boundary of
/// obstacle i, p_i its perimeter, of obstacles grown by the disc.
class Bug2 : public GuardedNavigator {
 public:
  Bug2(const NavigateOptions& options, const GoalTask& task);

 private:
  GoalStep plan(const lidar::Scan& scan, const core::Pose2& T_odom_robot) override;
  GoalStep toGoal(const core::Pose2& T_odom_robot);
  GoalStep follow(const core::Pose2& T_odom_robot);
  GoalStep step(const robot::Command& command, GoalStatus status = GoalStatus::kMoving) const;
  /// Signed distance from the line, positive on its left.
  double offLine(const core::Pose2& T_odom_robot) const;

  bool following_ = false;
  std::string reason_ = "start";
  std::optional<core::Pose2> T_odom_start_;
  BoundaryFollower follower_;
  double hit_goal_m_ = 0, last_off_m_ = 0;
};

}  // namespace slam::goals
