#pragma once
#include "libslam/goals/guarded_navigator.h"
#include "libslam/reach/reach_goal.h"

/// How to get to a goal with the lidar only. The base class keeps away from what the lidar shows and ends the
/// drive: at the goal, at the time limit, after a minute on one spot (libslam/goals/guarded_navigator.h);
/// this one says which way to go.
class @Name@ : public slam::goals::GuardedNavigator {
 public:
  @Name@(const slam::goals::NavigateOptions& options, const slam::goals::GoalTask& task)
      : GuardedNavigator(options, task) {}

 private:
  slam::goals::GoalStep plan(const slam::lidar::Scan& scan, const slam::core::Pose2& T_odom_robot) override;
};

/// What the closed loop makes it from.
slam::reach::OwnNavigator ownNavigator();
