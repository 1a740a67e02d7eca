#pragma once
#include <cstdint>

#include "libslam/core/pose2.h"
#include "libslam/core/random.h"
#include "libslam/robot/drive.h"
#include "libslam/robot/odometry_noise.h"

namespace slam::robot {

/// One wheel with its encoder: what it reports for the way that its contact point truly went.
class WheelEncoder {
 public:
  /// radius_error: true over assumed radius, less 1. A slip adds the robot's half.
  WheelEncoder(const OdometryOptions& options, double radius_error, core::RandomStream slips);
  /// Reported metres for `travel_m` true ones (negative: backwards).
  double measure(double travel_m);

 private:
  double slippedTravel(double travel_m);

  double radius_, slips_per_m_, slip_m_, tick_m_;
  core::RandomStream random_;
  double to_next_slip_m_;  ///< of true travel, either way
  double unreported_m_ = 0;
};

/// The odometry of a differential drive, step by step. In this order:
///
/// 1. The true arc and turn become two wheel travels about the true base wheel_base_m (1 + wheel_base_error).
/// 2. Each wheel slips: after every exponential length of true travel (slips_per_m on average, per wheel) it
///    turns in vain, in the direction of travel, by a length uniform in 0 .. 2 slip_m.
/// 3. A wheel whose radius is larger than assumed by the share e reports 1 / (1 + e) of its travel.
/// 4. The encoder counts whole ticks of tick_m; what is left counts in the next step, so that nothing is
///    lost.
/// 5. Both become an increment about the assumed base wheel_base_m, on the arc of a steady drive.
/// 6. sampleOdometry(): the noise and systematic errors of the older rows.
/// 7. With `gyro`, the heading is the gyroscope's, and the translation is turned by half of the difference.
///
/// The gyroscope reads the true turn plus bias * time plus noise of standard deviation gyro_noise *
/// sqrt(time); then the bias walks by a normal step of gyro_bias_walk * sqrt(time). It starts at gyro_bias.
///
/// Steps 1 to 5 and 7 are off by default, and then update() is sampleOdometry() of the drive, bit for bit.
/// Streams "odometry" (step 6 alone, whatever else is on), "odometry slips left", "odometry slips right",
/// "odometry gyro".
class Odometer {
 public:
  Odometer(const OdometryOptions& options, std::uint64_t seed);
  /// The increment reported for what the robot truly did; `elapsed_s` is the time since the last update,
  /// which is longer than driven.duration_s where a collision ended the drive early.
  core::Pose2 update(const Command& driven, double elapsed_s);

 private:
  core::Pose2 wheelIncrement(const Command& driven);
  double gyroTurn(double true_turn_rad, double elapsed_s);

  OdometryOptions options_;
  core::RandomStream random_, gyro_random_;
  WheelEncoder left_, right_;
  double gyro_bias_radps_;
};

}  // namespace slam::robot
