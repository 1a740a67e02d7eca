#pragma once
#include <optional>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/lidar/scan.h"
#include "libslam/obstacles/local_obstacle_map.h"
#include "libslam/obstacles/seen_floor.h"
#include "libslam/robot/drive.h"

namespace slam::goals {

/// What a careful robot with a narrow view does: floor that its sensor has not shown is unknown, not free, so
/// it looks there before it drives there.
///
/// Before a command whose way leads over floor that has not been seen (obstacles::SeenFloor) the robot turns
/// in place until its sensor faces the nearest such floor. Seen, the way is open. Faced and still not seen,
/// something hides it that stands too near to be seen itself (a camera's dead zone, a lidar's minimum range):
/// the place then counts as an obstacle until it is seen to be free. A bearing with a reading, or with none
/// up to the maximum range, shows the floor from the sensor on: whatever stood nearer than the sensor sees
/// would have hidden it.
class LookFirst {
 public:
  LookFirst(const robot::RobotOptions& robot, double period_s, const obstacles::LocalObstacleOptions& zone);

  /// The newest scan, taken at T_odom_robot (in any frame that stays put; finite).
  void update(const lidar::Scan& scan, const core::Pose2& T_odom_robot);
  /// While it turns to look: the command for this period. Nothing else is to be done then.
  std::optional<robot::Command> looking() const;
  /// The turn to be made in place of a command that leads over unseen floor; looking() goes on with it.
  /// Nothing where all of the way has been seen, and for commands that do not drive.
  std::optional<robot::Command> instead(const robot::Command& command);
  /// Whether the way of a command leads over unseen floor.
  bool leadsOverUnseen(const robot::Command& command) const { return unseenOn(command).has_value(); }
  /// What hides floor that was looked at, robot frame.
  std::vector<core::Point2> hidden() const;

 private:
  std::optional<core::Point2> unseenOn(const robot::Command& command) const;
  double rest(const core::Point2& p_odom) const;  ///< still to be turned to face it
  bool isFaced(const core::Point2& p_odom) const;
  void hide(const core::Point2& p_odom);

  robot::RobotOptions robot_;
  double period_s_, body_m_;
  obstacles::SeenFloor floor_;
  core::Pose2 T_odom_robot_, T_robot_sensor_;
  double half_view_rad_ = 0;
  std::optional<core::Point2> p_odom_look_;
  std::vector<core::Point2> hidden_odom_;
};

}  // namespace slam::goals
