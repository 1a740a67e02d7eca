#include "libslam/robot/lidar.h"

namespace slam::robot {
namespace {

bool isFullCircle(const LidarOptions& options) {
  return options.fov_rad > 2 * core::kPi - 1e-9;
}

}  // namespace

const core::ParameterTable<LidarOptions>& LidarOptions::table() {
  using O = LidarOptions;
  static const core::ParameterTable<O> rows(
      "lidar",
      {{"fov_deg", &O::fov_rad, 270.0, 1.0, 360.0, "angle from first to last beam; 360 is a full circle"},
       {"beams", &O::beams, 541, 2, 100000, "number of beams"},
       {"min_range_m", &O::min_range_m, 0.02, 0.0, 100.0, "nearer things give a lost reading"},
       {"max_range_m", &O::max_range_m, 30.0, 0.0, 10000.0, "farther things give no return; 0 is no limit"},
       {"sigma_m", &O::sigma_m, 0.01, 0.0, 10.0, "standard deviation of the Gaussian range noise"},
       {"drop_out", &O::drop_out, 0.0, 0.0, 1.0, "probability that a reading is lost"},
       {"rate_hz", &O::rate_hz, 5.0, 0.01, 1000.0, "scans per second"},
       {"mount_x_m", &O::mount_x_m, 0.0, -10.0, 10.0, "mounting pose: ahead of the robot's centre"},
       {"mount_y_m", &O::mount_y_m, 0.0, -10.0, 10.0, "mounting pose: left of the robot's centre"},
       {"mount_yaw_deg", &O::mount_yaw_rad, 0.0, -180.0, 180.0, "mounting pose: counter-clockwise"}});
  return rows;
}

LidarOptions::LidarOptions() {
  table().setDefaults(*this);
}

core::Pose2 mountingPose(const LidarOptions& options) {
  return {options.mount_x_m, options.mount_y_m, options.mount_yaw_rad};
}

double beamStep(const LidarOptions& options) {
  return isFullCircle(options) ? 2 * core::kPi / options.beams : options.fov_rad / (options.beams - 1);
}

double firstAngle(const LidarOptions& options) {
  return isFullCircle(options) ? -core::kPi : -options.fov_rad / 2;
}

void applyLidarErrors(const LidarOptions& options, core::RandomStream& random, std::vector<float>& ranges_m) {
  for (float& range_m : ranges_m) {
    const double noise_m = random.normal(options.sigma_m);
    const bool lost = random.chance(options.drop_out);
    if (lost) {
      range_m = kLostReading;
      continue;
    }
    if (!std::isfinite(range_m)) continue;
    const double exact_m = range_m;
    if (options.max_range_m > 0 && exact_m > options.max_range_m) {
      range_m = kNoReturn;
    } else if (exact_m < options.min_range_m || exact_m + noise_m <= 0) {
      range_m = kLostReading;
    } else {
      range_m = static_cast<float>(exact_m + noise_m);
      // Noise must not turn a reading into one that the sensor cannot give.
      if (options.max_range_m > 0)
        range_m = std::min(range_m, static_cast<float>(options.max_range_m) * (1.0F - 1e-6F));
    }
  }
}

}  // namespace slam::robot
