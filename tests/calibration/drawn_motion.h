#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "libslam/calibration/motion_series.h"
#include "libslam/core/random.h"

/// Drives of which all is known, as a lidar and odometry see them.
namespace slam::calibration::test_motion {

struct Robot {
  core::Pose2 T_robot_lidar;
  double distance_scale = 1, turn_scale = 1, drift_rad_per_m = 0;  ///< of the odometry
  double clock_s = 0;                 ///< the odometry's stamps are so much too late
  double noise_m = 0, noise_rad = 0;  ///< of each step by the lidar
  std::uint64_t seed = 1;
};

inline constexpr double kStep_s = 0.1;
inline const std::string kWheels = "wheels";

/// A robot on two wheels that drives curves to both sides, faster and slower, `steps` of a tenth of a second;
/// without turning or without driving when it is told so.
inline Stretch driven(const Robot& robot, int steps, double turning = 1, double driving = 1) {
  core::RandomStream random(robot.seed, "steps"), course(7, "course");
  Stretch stretch;
  core::Pose2 T_odom_robot;
  double rate = 0;
  stretch.odometry[kWheels].push_back({robot.clock_s, T_odom_robot});
  for (int k = 0; k < steps; ++k) {
    if (k % 10 == 0) rate = turning * 0.12 * course.normal();
    const double turn = rate, ahead_m = driving * (0.05 + 0.03 * std::sin(0.05 * k));
    // Along an arc, as wheels drive.
    const double half = turn / 2, chord_m = half == 0 ? ahead_m : ahead_m * std::sin(half) / half;
    const core::Pose2 moved{chord_m * std::cos(half), chord_m * std::sin(half), turn};
    ScanStep step;
    step.from_s = kStep_s * k, step.to_s = kStep_s * (k + 1);
    step.T_previous_lidar = core::inverse(robot.T_robot_lidar) * moved * robot.T_robot_lidar;
    step.T_previous_lidar.x += robot.noise_m * random.normal();
    step.T_previous_lidar.y += robot.noise_m * random.normal();
    step.T_previous_lidar.phi += robot.noise_rad * random.normal();
    step.is_matched = step.is_reliable = true;
    stretch.steps.push_back(step);
    core::Pose2 counted = moved;
    counted.x *= robot.distance_scale, counted.y *= robot.distance_scale;
    counted.phi = robot.turn_scale * turn + robot.drift_rad_per_m * ahead_m;
    T_odom_robot = T_odom_robot * counted;
    stretch.odometry[kWheels].push_back({step.to_s + robot.clock_s, T_odom_robot});
  }
  return stretch;
}

}  // namespace slam::calibration::test_motion
