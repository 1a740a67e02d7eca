#include "libslam/robot/odometry_noise.h"

#include <cmath>

namespace slam::robot {

const core::ParameterTable<OdometryOptions>& OdometryOptions::table() {
  using O = OdometryOptions;
  static const core::ParameterTable<O> rows(
      "odometry", {{"alpha1", &O::alpha1, 0.005, 0.0, 10.0, "rotation variance per squared rotation"},
                   {"alpha2", &O::alpha2, 0.005, 0.0, 10.0, "rotation variance per squared metre"},
                   {"alpha3", &O::alpha3, 0.005, 0.0, 10.0, "translation variance per squared metre"},
                   {"alpha4", &O::alpha4, 0.001, 0.0, 10.0, "translation variance per squared rotation"},
                   {"scale", &O::scale, 1.01, 0.1, 10.0, "systematic: reported over true distance"},
                   {"heading_bias_degpm", &O::heading_bias_radpm, 0.1, -90.0, 90.0,
                    "systematic: heading reported too large per metre driven"}});
  return rows;
}

OdometryOptions::OdometryOptions() {
  table().setDefaults(*this);
}

core::Pose2 sampleOdometry(const core::Pose2& T_before_after, const OdometryOptions& options,
                           core::RandomStream& random) {
  const double distance_m = std::hypot(T_before_after.x, T_before_after.y);
  const bool backward = T_before_after.x < 0;
  const double direction = backward ? -1.0 : 1.0;
  const double rot1 =
      distance_m == 0 ? 0.0 : std::atan2(direction * T_before_after.y, direction * T_before_after.x);
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
  return {reported_m * std::cos(noisy_rot1), reported_m * std::sin(noisy_rot1),
          core::wrapToPi(noisy_rot1 + noisy_rot2 + bias_rad)};
}

}  // namespace slam::robot
