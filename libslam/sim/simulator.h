#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/core/random.h"
#include "libslam/robot/drive.h"
#include "libslam/robot/lidar.h"
#include "libslam/robot/odometry_noise.h"
#include "libslam/robot/scan.h"
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
  double time_s;
  core::Pose2 T_world_robot;
};

/// The true world in motion: advances the truth by one command and senses it. Has its own clock (start_time_s
/// plus the durations of the commands), its own random streams ("lidar", "odometry"), and no noise on the
/// truth. The disc around the footprint never enters a wall: a command that would collide is cut at the last
/// free moment (to 1 mm or 0.1 degree) and recorded; time still passes. Errors: start in a wall or outside
/// the plan (InputError naming the pose), a command that is not finite or has negative duration
/// (ContractError).
class Simulator {
 public:
  Simulator(const world::Plan& plan, const robot::RobotOptions& robot, const robot::LidarOptions& lidar,
            const robot::OdometryOptions& odometry, const core::Pose2& start, std::uint64_t seed,
            double start_time_s = 1700000000.0);

  /// The first look, before any command.
  Sensed sense();
  Sensed step(const robot::Command& command);

  double time_s() const { return time_s_; }
  const core::Pose2& truth() const { return T_world_robot_; }  ///< for the recorder only
  const std::vector<Collision>& collisions() const { return collisions_; }

 private:
  const world::Plan& plan_;
  robot::RobotOptions robot_;
  robot::LidarOptions lidar_;
  robot::OdometryOptions odometry_;
  core::RandomStream lidar_random_, odometry_random_;
  core::Pose2 T_world_robot_, T_odom_robot_, T_previous_robot_;
  double start_time_s_, time_s_, elapsed_s_ = 0;
  bool collided_ = false;
  std::vector<Collision> collisions_;
};

}  // namespace slam::sim
