#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/robot/drive.h"
#include "libslam/robot/lidar.h"
#include "libslam/robot/odometer.h"
#include "libslam/robot/scan.h"
#include "libslam/sim/lidar_sensor.h"
#include "libslam/sim/recent_path.h"
#include "libslam/sim/scene.h"
#include "libslam/world/plan.h"

namespace slam::sim {

/// What the robot senses after a command. Nothing of the truth is in it.
struct Sensed {
  robot::Scan scan;
  core::Pose2 T_odom_robot;      ///< dead reckoning from the start
  core::Pose2 T_previous_robot;  ///< its last increment
  bool collided = false;         ///< the bumper: the command was cut short by an obstacle
};

/// A collision, for the report.
struct Collision {
  double time_s;  ///< of the moment of contact, not of the end of the command
  core::Pose2 T_world_robot;
};

/// The true world in motion: advances the truth by one command and senses it. Has its own clock (start_time_s
/// plus the durations of the commands, summed in whole nanoseconds so that nothing drifts), its own random
/// streams (those of LidarSensor and robot::Odometer), and no noise on the truth. The disc around the footprint never enters a
/// wall: a command that would collide is cut at the last free moment (to 1 mm of travel) and recorded; time
/// still passes. A turn in place never collides, for the disc is free. Between two checks of the path (at
/// most a quarter of a cell or 1 cm apart) the disc may cut a wall's corner by less than 0.1 mm.
///
/// Errors: lidar options that contradict each other (robot::requireSensible()); start not finite, in a wall, outside the plan or nearer to either than the disc's radius (InputError naming the pose
/// and the radius); a command that is not finite or has a negative duration (ContractError).
class Simulator {
 public:
  /// Keeps a reference to `plan`, which must outlive it and not change. Makes a world::SectorCaster: some
  /// milliseconds per million cells, and 8 bytes per cell.
  Simulator(const world::Plan& plan, const robot::RobotOptions& robot, const robot::LidarOptions& lidar,
            const robot::OdometryOptions& odometry, const core::Pose2& start, std::uint64_t seed,
            double start_time_s = 1700000000.0);
  Simulator(world::Plan&&, const robot::RobotOptions&, const robot::LidarOptions&,
            const robot::OdometryOptions&, const core::Pose2&, std::uint64_t, double = 0) = delete;

  /// The first look, before any command. Looking again draws new noise and moves nothing else.
  Sensed sense();
  /// Carries out one command and looks. A command of duration 0 only looks.
  Sensed step(const robot::Command& command);

  double time_s() const;
  const core::Pose2& truth() const { return T_world_robot_; }  ///< for the recorder only
  const std::vector<Collision>& collisions() const { return collisions_; }

 private:
  /// Seconds of the command until the disc would enter a wall; its whole duration when it never does.
  double freeDuration(const robot::Command& command) const;

  Scene scene_;
  robot::RobotOptions robot_;
  LidarSensor lidar_;
  robot::Odometer odometer_;
  RecentPath path_;
  core::Pose2 T_world_robot_, T_odom_robot_, T_previous_robot_;
  double start_time_s_;
  std::int64_t elapsed_ns_ = 0;
  bool collided_ = false;
  std::vector<Collision> collisions_;
};

}  // namespace slam::sim
