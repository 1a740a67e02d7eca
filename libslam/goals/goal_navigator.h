#pragma once
#include <memory>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/files/parameters.h"
#include "libslam/lidar/scan.h"
#include "libslam/obstacles/local_obstacle_map.h"
#include "libslam/robot/drive.h"

namespace slam::goals {

enum class GoalStatus { kMoving, kReached, kUnreachable, kGaveUp };
/// "moving", "reached", "unreachable", "gave up".
const char* statusName(GoalStatus status);

/// A change of a method's own state.
struct StateChangeWithin {
  std::string from, to, why;
};

/// What a goal navigator does in the next period, and why.
struct GoalStep {
  robot::Command command;  ///< for one period; stands still once the status is final
  GoalStatus status = GoalStatus::kMoving;
  std::string state;   ///< of the method's own state machine: "to goal", "WALL FOLLOW"
  std::string reason;  ///< of the last change of state, or of the end
  /// Every change of state that led to `state` since the step before, for methods that make several at once;
  /// empty for those that make one at most: it shows in `state`.
  std::vector<StateChangeWithin> changes = {};
  /// Where the method looked, robot frame: lidar_bug's places projected in its five strategic directions, in
  /// their order. Empty for the others, and when it ended before it looked.
  std::vector<core::Point2> p_robot_projected = {};
};

/// Drives to a goal in an unknown place, with the lidar and a pose, without a map.
///
/// The goal was given in the frame of the poses. A final status stays. Every navigator ends: with kReached
/// within the tolerance of the goal by its own pose; with kUnreachable when it has gone round what lies
/// between without finding a way; with kGaveUp at the time limit, after 5 s without one valid reading, after
/// a minute on one spot, when the pose is no longer finite, or when it is lost (the reason says which). Time
/// is the number of calls times the period. No command is longer than the period or faster than the robot,
/// and none brings the disc around the footprint nearer than 2 cm and one standard deviation of the range to
/// anything that the lidar shows. With `unseen` = looked_at none leads the disc over floor that was not seen
/// before, and a robot whose sensor shows nothing goes on by what it remembers. The same scans and poses give
/// the same commands.
class GoalNavigator {
 public:
  virtual ~GoalNavigator() = default;
  /// `collided`: the bumper cut the last command short. Things that the lidar does not show are remembered
  /// where they were felt.
  virtual GoalStep next(const lidar::Scan& scan, const core::Pose2& T_odom_robot, bool collided) = 0;
};

/// Section [lidar_bug]: the figures of the original state machine that its description gives, and those
/// that it leaves open. Distances are from the robot's centre.
struct LidarBugOptions {
  double stop_radius_m, invalid_below_m;
  double obstacle_range_m, side_range_m, wall_distance_m, wall_lost_m, clear_front_m;
  double back_off_m, stuck_turn_rad, drive_on_m, near_goal_m, off_course_rad;
  int bumps_in_a_row;
  std::string wall_end;
  LidarBugOptions();
  static const files::ParameterTable<LidarBugOptions>& table();
};

/// Section [navigate].
struct NavigateOptions {
  double goal_tolerance_m, clearance_m, boundary_tolerance_m, time_limit_s;
  std::string turn;
  double sensor_range_m;
  std::string memory;  ///< a name of obstacleMemoryNames()
  std::string unseen;  ///< floor that the sensor has not shown: free | looked_at (see LookFirst)
  LidarBugOptions lidar_bug;
  obstacles::LocalObstacleOptions obstacles;  ///< the zone of memory = local_map and unseen = looked_at
  NavigateOptions();
  static const files::ParameterTable<NavigateOptions>& table();
};

/// Where to, with what.
struct GoalTask {
  core::Point2 p_odom_goal;
  robot::RobotOptions robot;
  double period_s = 0.2;
};

/// Errors: unknown name (InputError with the nearest one); goal not finite, period not positive
/// (ContractError).
std::unique_ptr<GoalNavigator> makeGoalNavigator(const std::string& name, const NavigateOptions& options,
                                                 const GoalTask& task);
std::vector<std::string> goalNavigatorNames();
/// One line for lists. REQUIRES a name of goalNavigatorNames() (ContractError).
std::string goalNavigatorMeaning(const std::string& name);

}  // namespace slam::goals
