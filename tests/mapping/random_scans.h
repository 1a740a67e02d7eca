#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "libslam/core/random.h"
#include "libslam/lidar/scan.h"

namespace slam::mapping::test {

/// What comes to an estimator at one step.
struct RandomStep {
  lidar::Scan scan;
  core::Pose2 T_previous_robot;
  bool has_odometry = true;
};

/// Steps as no robot would give them, of one lidar drawn at random: from 2 beams on, over any angle; scans of
/// one wall, of a circle, of nothing, of noise, the same again; readings that are no numbers; odometry that
/// stands still, leaps, or is missing.
class RandomSteps {
 public:
  /// most_beams: at least 2. leap_m: of odometry, in one step.
  RandomSteps(std::uint64_t seed, int most_beams, double leap_m)
      : chance_(seed, "random steps"), leap_m_(leap_m) {
    const double beams = std::exp(chance_.uniform(std::log(2.0), std::log(most_beams + 1.0)));
    lidar_.ranges_m.resize(static_cast<size_t>(beams));
    const double fov_rad = chance_.uniform(1e-3, 2 * core::kPi);
    lidar_.step_rad = fov_rad / static_cast<double>(lidar_.ranges_m.size());
    lidar_.first_angle_rad = chance_.uniform(-core::kPi, core::kPi);
    lidar_.max_range_m = std::exp(chance_.uniform(std::log(0.5), std::log(200.0)));
    lidar_.range_sigma_m = 0.01;
    if (chance_.chance(0.5))
      lidar_.T_robot_lidar = {chance_.normal(), chance_.normal(), 3 * chance_.normal()};
    noise_m_ = chance_.chance(0.3) ? 0 : 0.02;
    kind_ = static_cast<int>(chance_.below(kKinds));
    lidar_.time_s = 1000;
  }

  RandomStep next() {
    if (chance_.chance(0.3)) kind_ = static_cast<int>(chance_.below(kKinds));
    RandomStep step;
    lidar_.time_s += 0.1;
    const bool is_repeated = chance_.chance(0.2);
    if (!is_repeated) drawReadings();
    step.scan = lidar_;
    step.T_previous_robot = motion();
    step.has_odometry = chance_.chance(0.8);
    return step;
  }

 private:
  static constexpr int kKinds = 8;

  double reading(size_t beam) {
    const double angle = lidar_.angle(beam);
    const double most = lidar_.max_range_m;
    switch (kind_) {
      case 0:
        return 0.3 * most;  // a circle
      case 1:
        return 0.2 * most / std::cos(angle);  // one wall ahead
      case 2:
        return lidar::kNoReturn;  // nothing at all
      case 3:
        return chance_.uniform(0, most);  // noise
      case 4:
        return 0.1 * most / std::max(std::abs(std::sin(angle)), 1e-9);  // a corridor
      case 5:
        return 1e-3;  // covered
      case 6:
        return lidar::kLostReading;
      default:
        return 0.2 * most / std::max(std::abs(std::sin(angle)), std::abs(std::cos(angle)));  // a room
    }
  }

  void drawReadings() {
    const bool is_spoilt = chance_.chance(0.3);
    for (size_t i = 0; i < lidar_.ranges_m.size(); ++i) {
      double range_m = reading(i) + noise_m_ * chance_.normal();
      if (!(range_m > 0 && range_m < lidar_.max_range_m) && !std::isnan(range_m)) range_m = lidar::kNoReturn;
      if (is_spoilt && chance_.chance(0.2))
        range_m = chance_.chance(0.5) ? lidar::kLostReading : (chance_.chance(0.5) ? 0 : -1);
      lidar_.ranges_m[i] = static_cast<float>(range_m);
    }
  }

  core::Pose2 motion() {
    switch (chance_.below(6)) {
      case 0:
        return {};
      case 1:
        return {leap_m_ * chance_.normal(), leap_m_ * chance_.normal(), 3 * chance_.normal()};
      case 2:
        return {-0.2, 0, 0};
      default:
        return {0.2 * chance_.uniform(), 0.01 * chance_.normal(), 0.1 * chance_.normal()};
    }
  }

  core::RandomStream chance_;
  lidar::Scan lidar_;
  double leap_m_, noise_m_ = 0;
  int kind_ = 0;
};

}  // namespace slam::mapping::test
