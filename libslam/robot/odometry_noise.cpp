#include "libslam/robot/odometry_noise.h"

#include <cmath>

#include "libslam/core/elementary.h"

namespace slam::robot {

const files::ParameterTable<OdometryOptions>& OdometryOptions::table() {
  using O = OdometryOptions;
  static const files::ParameterTable<O> rows(
      "odometry",
      {{"alpha1", &O::alpha1, 0.005, 0.0, 10.0, "rotation variance per squared rotation"},
       {"alpha2", &O::alpha2, 0.005, 0.0, 10.0, "rotation variance per squared metre"},
       {"alpha3", &O::alpha3, 0.005, 0.0, 10.0, "translation variance per squared metre"},
       {"alpha4", &O::alpha4, 0.001, 0.0, 10.0, "translation variance per squared rotation"},
       {"scale", &O::scale, 1.01, 0.1, 10.0, "systematic: reported over true distance"},
       {"heading_bias_degpm", &O::heading_bias_radpm, 0.1, -90.0, 90.0,
        "systematic: heading reported too large per metre driven"},
       {"wheel_base_m", &O::wheel_base_m, 0.35, 0.01, 10.0, "distance of the wheels, as assumed"},
       {"wheel_base_error", &O::wheel_base_error, 0.0, -0.5, 1.0, "true over assumed, less 1"},
       {"wheel_radius_left_error", &O::wheel_radius_left_error, 0.0, -0.5, 1.0, "true over assumed, less 1"},
       {"wheel_radius_right_error", &O::wheel_radius_right_error, 0.0, -0.5, 1.0,
        "true over assumed, less 1"},
       {"slips_per_m", &O::slips_per_m, 0.0, 0.0, 1000.0,
        "how often each wheel turns in vain per metre of its way"},
       {"slip_m", &O::slip_m, 0.02, 0.0, 10.0, "mean length of such a slip"},
       {"tick_m", &O::tick_m, 0.0, 0.0, 1.0, "travel per encoder tick; 0 is no ticks"},
       {"gyro", &O::gyro, false, "headings from a gyroscope instead of the wheels"},
       {"gyro_bias_degps", &O::gyro_bias_radps, 0.0, -90.0, 90.0, "gyroscope: bias at the start"},
       {"gyro_bias_walk_degps", &O::gyro_bias_walk_radps, 0.0, 0.0, 90.0,
        "gyroscope: standard deviation of the bias's walk after 1 s; grows with the root of time"},
       {"gyro_noise_degps", &O::gyro_noise_radps, 0.0, 0.0, 90.0,
        "gyroscope: standard deviation of the heading (deg) after 1 s; grows with the root of time"}});
  return rows;
}

OdometryOptions::OdometryOptions() {
  table().setDefaults(*this);
}

core::Pose2 sampleOdometry(const core::Pose2& T_before_after, const OdometryOptions& options,
                           core::RandomStream& random) {
  const double distance_m = core::hypot(T_before_after.x, T_before_after.y);
  const bool backward = T_before_after.x < 0;
  const double direction = backward ? -1.0 : 1.0;
  const double rot1 =
      distance_m == 0 ? 0.0 : core::atan2(direction * T_before_after.y, direction * T_before_after.x);
  const double trans = direction * distance_m;
  const double rot2 = core::wrapToPi(T_before_after.phi - rot1);

  // Probabilistic Robotics (Thrun, Burgard, Fox 2005), table 5.6, lines 5 to 7, as variances.
  const auto sigma = [](double variance) { return std::sqrt(variance); };
  const double t2 = trans * trans;
  const double noisy_rot1 = rot1 - random.normal(sigma(options.alpha1 * rot1 * rot1 + options.alpha2 * t2));
  const double noisy_trans =
      trans - random.normal(sigma(options.alpha3 * t2 + options.alpha4 * (rot1 * rot1 + rot2 * rot2)));
  const double noisy_rot2 = rot2 - random.normal(sigma(options.alpha1 * rot2 * rot2 + options.alpha2 * t2));

  const double reported_m = noisy_trans * options.scale;
  const double bias_rad = options.heading_bias_radpm * distance_m;
  return {reported_m * core::cos(noisy_rot1), reported_m * core::sin(noisy_rot1),
          core::wrapToPi(noisy_rot1 + noisy_rot2 + bias_rad)};
}

}  // namespace slam::robot
