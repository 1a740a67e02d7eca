#include "libslam/lidar/lidar.h"

#include "libslam/core/error.h"

namespace slam::lidar {
namespace {

bool isFullCircle(const LidarOptions& options) {
  return options.fov_rad > 2 * core::kPi - 1e-9;
}

double quantised(double range_m, double quantum_m) {
  return quantum_m > 0 ? std::round(range_m / quantum_m) * quantum_m : range_m;
}

/// Below max_range_m: a reading there would be none (see fromMrpt()).
float largestReading(const LidarOptions& options) {
  const double below_m = static_cast<float>(options.max_range_m) * (1.0F - 1e-6F);
  if (options.quantum_m == 0) return static_cast<float>(below_m);
  return static_cast<float>(std::floor(below_m / options.quantum_m) * options.quantum_m);
}

}  // namespace

const files::ParameterTable<LidarOptions>& LidarOptions::table() {
  using O = LidarOptions;
  static const files::ParameterTable<O> rows(
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
       {"mount_yaw_deg", &O::mount_yaw_rad, 0.0, -180.0, 180.0, "mounting pose: counter-clockwise"},
       {"sigma_share", &O::sigma_share, 0.0, 0.0, 1.0, "noise of this share of the range where that is more"},
       {"quantum_m", &O::quantum_m, 0.0, 0.0, 1.0, "readings are multiples of this; 0 is any number"},
       {"beam_width_deg", &O::beam_width_rad, 0.0, 0.0, 10.0, "full angle of the cone of one beam"},
       {"mixed_pixels", &O::mixed_pixels, 0.0, 0.0, 1.0,
        "probability that a beam split by an edge reads between both sides; needs a beam_width_deg"},
       {"sweep", &O::sweep, 0.0, 0.0, 1.0,
        "share of the period 1 / rate_hz that a sweep takes while the robot moves; 0 is all at once"},
       {"sweep_clockwise", &O::sweep_clockwise, false, "the sweep begins with the scan's last beam"},
       {"latency_s", &O::latency_s, 0.0, 0.0, 10.0, "the stamp is later than the last beam by so much"},
       {"mount_error_x_m", &O::mount_error_x_m, 0.0, -10.0, 10.0, "true less stated mounting pose: ahead"},
       {"mount_error_y_m", &O::mount_error_y_m, 0.0, -10.0, 10.0, "true less stated mounting pose: left"},
       {"mount_error_yaw_deg", &O::mount_error_yaw_rad, 0.0, -180.0, 180.0,
        "true less stated mounting pose: counter-clockwise"},
       {"dark_range_m", &O::dark_range_m, 0.0, 0.0, 10000.0,
        "farther dark surfaces of the plan's materials give no return; 0 is as any other surface"},
       {"glass_echo", &O::glass_echo, 1.0, 0.0, 1.0,
        "probability that glass of the plan's materials answers a beam head on"},
       {"glass_echo_deg", &O::glass_echo_rad, 5.0, 0.01, 90.0, "incidence that halves glass_echo"},
       {"glass_reflectance", &O::glass_reflectance, 0.08, 0.0, 1.0,
        "share of unanswered beams that glass mirrors head on; it grows to 1 at grazing incidence"},
       {"ray",
        &O::ray,
        "exact",
        {"exact", "original"},
        "range to the wall's face, or the original walk from pixel to pixel; that knows plain walls only"}});
  return rows;
}

LidarOptions::LidarOptions() {
  table().setDefaults(*this);
}

void requireSensible(const LidarOptions& options) {
  const auto requireBelowMaximum = [&](const char* key, double value_m) {
    if (options.max_range_m > 0 && value_m >= options.max_range_m)
      throw core::InputError(
          "section [lidar], key '" + std::string(key) + "': found '" + files::formatNumber(value_m) +
          "', expected less than max_range_m = " + files::formatNumber(options.max_range_m));
  };
  requireBelowMaximum("min_range_m", options.min_range_m);
  requireBelowMaximum("quantum_m", options.quantum_m);
}

core::Pose2 mountingPose(const LidarOptions& options) {
  return {options.mount_x_m, options.mount_y_m, options.mount_yaw_rad};
}

core::Pose2 trueMountingPose(const LidarOptions& options) {
  return {options.mount_x_m + options.mount_error_x_m, options.mount_y_m + options.mount_error_y_m,
          options.mount_yaw_rad + options.mount_error_yaw_rad};
}

double beamStep(const LidarOptions& options) {
  return isFullCircle(options) ? 2 * core::kPi / options.beams : options.fov_rad / (options.beams - 1);
}

double firstAngle(const LidarOptions& options) {
  return isFullCircle(options) ? -core::kPi : -options.fov_rad / 2;
}

double rangeSigma(const LidarOptions& options, double range_m) {
  return std::max(options.sigma_m, options.sigma_share * range_m);
}

double statedSigma(const LidarOptions& options) {
  return rangeSigma(options, 3.0);
}

double secondsBeforeLastBeam(const LidarOptions& options, int beam) {
  const int beams_after = options.sweep_clockwise ? beam : options.beams - 1 - beam;
  return options.sweep / options.rate_hz * beams_after / options.beams;
}

void applyLidarErrors(const LidarOptions& options, core::RandomStream& random, std::vector<float>& ranges_m) {
  const float largest_m = largestReading(options);
  for (float& range_m : ranges_m) {
    const double noise = random.normal();
    const bool lost = random.chance(options.drop_out);
    if (lost) {
      range_m = kLostReading;
      continue;
    }
    if (!std::isfinite(range_m)) continue;
    const double exact_m = range_m;
    const double reading_m = quantised(exact_m + rangeSigma(options, exact_m) * noise, options.quantum_m);
    if (options.max_range_m > 0 && exact_m > options.max_range_m) {
      range_m = kNoReturn;
    } else if (exact_m < options.min_range_m || reading_m <= 0) {
      range_m = kLostReading;
    } else {
      range_m = static_cast<float>(reading_m);
      // Noise must not turn a reading into one that the sensor cannot give.
      if (options.max_range_m > 0) range_m = std::min(range_m, largest_m);
    }
  }
}

}  // namespace slam::lidar
