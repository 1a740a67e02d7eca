#pragma once
#include "libslam/core/pose2.h"
#include "libslam/core/random.h"
#include "libslam/files/parameters.h"

namespace slam::robot {

/// Errors of wheel odometry; section [odometry]. The rows from wheel_base_m on are Odometer's, and off at
/// their defaults.
struct OdometryOptions {
  double alpha1, alpha2, alpha3,
      alpha4;                 ///< Thrun, Burgard and Fox, Probabilistic Robotics (2005), table 5.6
  double scale;               ///< systematic: reported over true distance
  double heading_bias_radpm;  ///< systematic: heading reported too large per metre driven
  double wheel_base_m;        ///< distance of the wheels, as the robot assumes it
  double wheel_base_error;    ///< true over assumed, less 1
  double wheel_radius_left_error, wheel_radius_right_error;  ///< true over assumed, less 1
  double slips_per_m, slip_m;                                ///< of each wheel: how often, mean length
  double tick_m;                                             ///< travel per encoder tick; 0 = no ticks
  bool gyro;                                                 ///< headings from a gyroscope
  double gyro_bias_radps;                                    ///< at the start
  double gyro_bias_walk_radps, gyro_noise_radps;             ///< standard deviation after one second
  OdometryOptions();
  static const files::ParameterTable<OdometryOptions>& table();
};

/// What the wheels report for a true increment T_before_after: decomposed into turn, drive, turn, each with
/// noise of variance alpha1 rot^2 + alpha2 trans^2 and so on (Probabilistic Robotics, table 5.6), then the
/// systematic errors. A backward drive is decomposed as a backward drive, not as two half turns.
core::Pose2 sampleOdometry(const core::Pose2& T_before_after, const OdometryOptions& options,
                           core::RandomStream& random);

}  // namespace slam::robot
