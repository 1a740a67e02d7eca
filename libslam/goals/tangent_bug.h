#pragma once
#include <optional>
#include <vector>

#include "libslam/goals/boundary_follower.h"
#include "libslam/goals/guarded_navigator.h"

namespace slam::goals {

/// TangentBug (Kamon, Rimon and Rivlin, "TangentBug: a range-sensor-based navigation algorithm", Int. J. of
/// Robotics Research 17(9), 1998) with a lidar of finite range, for a disc.
///
/// To goal: straight while the way is free as far as the lidar sees; else towards the node O of the local
/// tangent graph (the ends of what the disc can see of the obstacles) with the shortest d(x, O) + d(O, goal)
/// among those nearer to the goal than the robot; with no such node, on against the obstacle until it is
/// touched: a local minimum of the distance to the goal. Boundary: follow it to the side of the better node
/// until some visible place is nearer to the goal than any that was driven on it, then go there (transition)
/// and on. Back where the boundary was met without that: the goal cannot be reached.
///
/// Where we differ: the nearest distance on the followed boundary is that of places driven, not of all places
/// sensed, and leaving needs 0.2 m of progress (and 0.2 m
/// more after every way that proved blocked), against noise.
class TangentBug : public GuardedNavigator {
 public:
  TangentBug(const NavigateOptions& options, const GoalTask& task);

 private:
  enum class State { kToGoal, kBoundary, kTransition };
  struct Node {
    core::Point2 p_robot;
    double goal_m, cost_m;  ///< d(O, goal) and d(x, O) + d(O, goal)
  };

  GoalStep plan(const lidar::Scan& scan, const core::Pose2& T_odom_robot) override;
  GoalStep toGoal(const lidar::Scan& scan, const core::Pose2& T_odom_robot);
  GoalStep follow(const lidar::Scan& scan, const core::Pose2& T_odom_robot);
  GoalStep transition(const core::Pose2& T_odom_robot);
  GoalStep step(const robot::Command& command, GoalStatus status = GoalStatus::kMoving) const;

  void look(const lidar::Scan& scan);
  std::vector<Node> nodes(const core::Pose2& T_odom_robot) const;
  std::optional<core::Point2> visiblePlaceNearerThan(double goal_m, const core::Pose2& T_odom_robot) const;
  /// The node chosen before while it can be driven to, robot frame.
  std::optional<core::Point2> headingTo(const core::Pose2& T_odom_robot) const;
  GoalStep driveTo(const core::Point2& p_robot) const;
  std::optional<core::Point2> chooseNode(const std::vector<Node>& all, const core::Pose2& T_odom_robot) const;
  bool isSeen(const lidar::Scan& scan, double direction_rad) const;

  State state_ = State::kToGoal;
  std::string reason_ = "start";
  std::vector<double> free_m_;  ///< per degree from straight back: how far the disc can go, at most to the
                                ///< sensor's range; NaN where the lidar does not look
  double range_m_ = 0;
  BoundaryFollower follower_;
  std::optional<core::Point2> p_odom_heading_to_;
  core::Point2 p_odom_place_;
  double nearest_goal_m_ = 0, needed_progress_m_ = 0;
};

}  // namespace slam::goals
