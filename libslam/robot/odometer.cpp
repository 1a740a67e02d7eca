#include "libslam/robot/odometer.h"

#include <cmath>
#include <limits>

#include "libslam/core/elementary.h"

namespace slam::robot {
namespace {

bool hasWheelErrors(const OdometryOptions& o) {
  return o.wheel_radius_left_error != 0 || o.wheel_radius_right_error != 0 || o.wheel_base_error != 0 ||
         (o.slips_per_m > 0 && o.slip_m > 0) || o.tick_m > 0;
}

double drawLengthToSlip(core::RandomStream& random, double slips_per_m) {
  if (slips_per_m <= 0) return std::numeric_limits<double>::infinity();
  return -core::log1p(-random.uniform()) / slips_per_m;
}

}  // namespace

WheelEncoder::WheelEncoder(const OdometryOptions& options, double radius_error, core::RandomStream slips)
    : radius_(1 + radius_error),
      slips_per_m_(options.slips_per_m),
      slip_m_(options.slip_m),
      tick_m_(options.tick_m),
      random_(slips),
      to_next_slip_m_(drawLengthToSlip(random_, slips_per_m_)) {}

double WheelEncoder::slippedTravel(double travel_m) {
  double turned_m = travel_m;
  to_next_slip_m_ -= std::abs(travel_m);
  while (to_next_slip_m_ <= 0) {
    turned_m += std::copysign(random_.uniform(0, 2 * slip_m_), travel_m);
    to_next_slip_m_ += drawLengthToSlip(random_, slips_per_m_);
  }
  return turned_m;
}

double WheelEncoder::measure(double travel_m) {
  const double reported_m = slippedTravel(travel_m) / radius_;
  if (tick_m_ == 0) return reported_m;
  unreported_m_ += reported_m;
  const double counted_m = std::trunc(unreported_m_ / tick_m_) * tick_m_;
  unreported_m_ -= counted_m;
  return counted_m;
}

Odometer::Odometer(const OdometryOptions& options, std::uint64_t seed)
    : options_(options),
      random_(seed, "odometry"),
      gyro_random_(seed, "odometry gyro"),
      left_(options, options.wheel_radius_left_error, {seed, "odometry slips left"}),
      right_(options, options.wheel_radius_right_error, {seed, "odometry slips right"}),
      gyro_bias_radps_(options.gyro_bias_radps) {}

core::Pose2 Odometer::wheelIncrement(const Command& driven) {
  const double arc_m = driven.speed_mps * driven.duration_s;
  const double turn_rad = driven.turn_rate_radps * driven.duration_s;
  const double half_base_m = 0.5 * options_.wheel_base_m * (1 + options_.wheel_base_error);
  const double left_m = left_.measure(arc_m - half_base_m * turn_rad);
  const double right_m = right_.measure(arc_m + half_base_m * turn_rad);
  return driveMotion({0.5 * (left_m + right_m), (right_m - left_m) / options_.wheel_base_m, 1.0});
}

double Odometer::gyroTurn(double true_turn_rad, double elapsed_s) {
  const double root_s = std::sqrt(elapsed_s);
  const double turn_rad =
      true_turn_rad + gyro_bias_radps_ * elapsed_s + gyro_random_.normal(options_.gyro_noise_radps * root_s);
  gyro_bias_radps_ += gyro_random_.normal(options_.gyro_bias_walk_radps * root_s);
  return turn_rad;
}

core::Pose2 Odometer::update(const Command& driven, double elapsed_s) {
  const core::Pose2 T_before_after = hasWheelErrors(options_) ? wheelIncrement(driven) : driveMotion(driven);
  const core::Pose2 wheels = sampleOdometry(T_before_after, options_, random_);
  if (!options_.gyro) return wheels;
  const double turn_rad = gyroTurn(driven.turn_rate_radps * driven.duration_s, elapsed_s);
  const double half_difference_rad = 0.5 * core::angleDifference(turn_rad, wheels.phi);
  const core::Point2 moved = core::Pose2{0, 0, half_difference_rad} * core::position(wheels);
  return {moved.x, moved.y, core::wrapToPi(turn_rad)};
}

}  // namespace slam::robot
