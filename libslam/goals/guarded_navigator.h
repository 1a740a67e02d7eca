#pragma once
#include <optional>
#include <string>

#include "libslam/goals/goal_navigator.h"
#include "libslam/goals/look_first.h"
#include "libslam/goals/surroundings.h"

namespace slam::goals {

/// What all goal navigators share: the ends that GoalNavigator promises, the bumper, the safe commands.
/// A method says in plan() what to do while none of the ends has come.
class GuardedNavigator : public GoalNavigator {
 public:
  GuardedNavigator(const NavigateOptions& options, const GoalTask& task);
  GoalStep next(const lidar::Scan& scan, const core::Pose2& T_odom_robot, bool collided) final;

 protected:
  virtual GoalStep plan(const lidar::Scan& scan, const core::Pose2& T_odom_robot) = 0;
  /// The end has come before the method noticed: its state's name for it.
  virtual std::string endState(GoalStatus status) const { return statusName(status); }

  bool looksFirst() const { return look_first_.has_value(); }
  double goalDistance(const core::Pose2& T_odom_robot) const;
  double goalDirection(const core::Pose2& T_odom_robot) const;  ///< robot frame
  /// Near the goal, where only the disc itself has to fit, the guard's radius; the pass radius elsewhere.
  double approachRadius(const core::Pose2& T_odom_robot) const;
  /// How far the way straight to the goal is free; at most to the goal.
  double freeToGoal(const core::Pose2& T_odom_robot) const;

  const NavigateOptions options_;
  const GoalTask task_;
  Surroundings surroundings_;

 private:
  GoalStep end(GoalStatus status, const std::string& reason);
  /// The step before once more, with another command.
  GoalStep goOn(const robot::Command& command);
  bool standsStill(const core::Pose2& T_odom_robot);

  std::optional<LookFirst> look_first_;
  double elapsed_s_ = 0, blind_s_ = 0, still_s_ = 0;
  bool has_spot_ = false;
  core::Pose2 T_odom_spot_;
  double last_speed_mps_ = 0;
  GoalStep last_;
};

/// "(3.20, 1.05)".
std::string describe(const core::Point2& p);

}  // namespace slam::goals
