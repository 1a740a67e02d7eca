#pragma once
#include <array>
#include <string>
#include <vector>

#include "libslam/goals/guarded_navigator.h"

namespace slam::goals {

/// The original goal navigation: a state machine on five strategic directions of the lidar. Its diagram, made
/// from the table of transitions, is in lidar_bug.md. It has no guarantee: it can circle in a trap until the
/// time limit.
///
/// Every period it looks all around, reads the five strategic directions, projects the places reached by
/// moving that way, and then makes as many transitions as the look calls for (four at most, each of them in
/// GoalStep::changes).
///
/// Where we differ; the same list stands in lidar_bug.md:
///   - the stop radius is 0.22 m, but never less than what the robot's circle needs (lidarBugStopRadius());
///     configs/navigate/thesis.ini has a robot that fits into it, so there it is the document's to the
///     letter;
///   - where the wall ends, `wall_end = front` turns until the front is clear and drives on, as described;
///     ours, `goal`, the default, turns on until the goal's side is clear, because the front of a robot that
///     follows a wall is clear already;
///   - directions are angles and not indices of 275 readings, so that any lidar will do: the nearest reading
///     within 3 degrees counts;
///   - readings are measured from the robot's centre, wherever the lidar is mounted;
///   - every command is guarded: it is shortened where it would touch something;
///   - it gives up at a time limit, without any valid reading, and when a full turn shows no clear front;
///   - what the description leaves open (distances, how far to turn) are rows of [lidar_bug].
enum class LidarBugState {
  kTurnToGoal,
  kDriveForward,
  kDriveAtGoal,
  kAvoidTurn,
  kAvoidDrive,
  kWallFollow,
  kOpenTurn,
  kOpenDrive,
  kStuckLeave,
  kStuckTurn,
  kStuckReturn,
  kStuckClear,
  kReached,
  kGaveUp
};
inline constexpr int kLidarBugStates = 14;
const char* lidarBugStateName(LidarBugState state);  ///< "WALL FOLLOW"

enum class LidarBugEvent {
  kFacingGoal,
  kOffCourse,
  kGoalNear,
  kGoalFar,
  kObstacleInRange,
  kFrontClear,
  kDrivenOn,
  kSidesOpen,
  kBump,
  kManyBumps,
  kMovedAway,
  kTurnedAway,
  kReturned,
  kNoClearFront,
  kGoalReached,
  kEnded
};
const char* lidarBugEventName(LidarBugEvent event);  ///< "obstacle in range"

struct LidarBugTransition {
  LidarBugState from;
  LidarBugEvent event;
  LidarBugState to;
};
/// Every transition that the machine can make, one row per state and event.
const std::vector<LidarBugTransition>& lidarBugTransitions();
/// The same as a document with a Mermaid diagram and the list of differences: the content of lidar_bug.md.
std::string lidarBugDiagram();

/// The five strategic directions of the original scan of 275 readings (indices 0, 28, 68, 207, 247), as
/// angles in (-pi, pi], counter-clockwise positive: ahead, left ahead, left, right, right ahead.
std::array<double, 5> strategicDirections();
enum StrategicDirection { kAhead = 0, kLeftAhead = 1, kLeft = 2, kRight = 3, kRightAhead = 4 };

/// The stop radius in force: stop_radius_m, or 3 cm more than guard_m, the distance at which the guard of
/// every command would stop the robot anyway (the circle around its footprint, 2 cm and one standard
/// deviation of the range), where that is larger. The default robot (0.4 m square, sigma 1 cm): 0.343 m.
double lidarBugStopRadius(const LidarBugOptions& options, double guard_m);

class LidarBug : public GuardedNavigator {
 public:
  LidarBug(const NavigateOptions& options, const GoalTask& task);

 private:
  GoalStep plan(const lidar::Scan& scan, const core::Pose2& T_odom_robot) override;
  std::string endState(GoalStatus status) const override;

  void look(const lidar::Scan& scan, const core::Pose2& T_odom_robot);
  void recall(const std::array<double, 5>& aside_rad);
  void fire(LidarBugEvent event, const core::Pose2& T_odom_robot, const std::string& detail);
  /// One look at the present state: true when it was left.
  bool decide(const core::Pose2& T_odom_robot);
  bool decideDriving(const core::Pose2& T_odom_robot);
  bool decideTurning(const core::Pose2& T_odom_robot);
  bool decideStuck(const core::Pose2& T_odom_robot);
  robot::Command act(const core::Pose2& T_odom_robot) const;
  robot::Command followWall() const;

  double stopRadius() const { return lidarBugStopRadius(options_.lidar_bug, surroundings_.guardRadius()); }
  bool frontClear(double limit_m) const;
  bool obstacleInRange() const;
  bool isDriving() const;
  double travelled(const core::Pose2& T_odom_robot) const;
  double chooseTurn() const;

  LidarBugState state_ = LidarBugState::kTurnToGoal;
  std::string reason_ = "start";
  std::array<double, 5> readings_m_{};  ///< of the strategic directions; +infinity: nothing there
  std::array<core::Point2, 5> p_robot_projected_{},
      p_odom_projected_{};                          ///< places reached by moving that way
  std::vector<StateChangeWithin> changes_;          ///< of this period
  double bump_bearing_rad_ = 0, bump_range_m_ = 0;  ///< of the nearest reading
  bool bump_in_front_ = true;
  int bumps_in_a_row_ = 0;
  core::Pose2 T_odom_bump_;
  core::Pose2 T_odom_remembered_;  ///< where the present state began
  double turn_sign_ = 1, turned_rad_ = 0, last_heading_rad_ = 0;
};

}  // namespace slam::goals
