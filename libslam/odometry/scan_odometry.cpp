#include "libslam/odometry/scan_odometry.h"

#include <cmath>

#include "libslam/core/error.h"
#include "libslam/odometry/methods.h"

namespace slam::odometry {

ScanOdometryOptions::ScanOdometryOptions() {
  table().setDefaults(*this);
}

const core::ParameterTable<ScanOdometryOptions>& ScanOdometryOptions::table() {
  static const core::ParameterTable<ScanOdometryOptions> rows(
      "scan_odometry",
      {{"method", &ScanOdometryOptions::method, "correlation", scanOdometryNames(),
        "argmax: the longest range and two readings; correlation: all beams, with covariance"},
       {"max_turn_deg", &ScanOdometryOptions::max_turn_rad, 60.0, 1.0, 180.0,
        "largest turn between two scans that is searched for"},
       {"max_move_m", &ScanOdometryOptions::max_move_m, 2.0, 0.01, 100.0,
        "largest move between two scans that is believed"}});
  return rows;
}

std::vector<std::string> scanOdometryNames() {
  return {"argmax", "correlation"};
}

std::unique_ptr<ScanOdometry> makeScanOdometry(const ScanOdometryOptions& options) {
  if (options.method == "argmax") return makeArgmaxOdometry(options);
  if (options.method == "correlation") return makeCorrelationOdometry(options);
  throw core::InputError("[scan_odometry] method: found '" + options.method +
                         "', expected argmax or correlation" +
                         core::didYouMean(options.method, scanOdometryNames()));
}

void requireUsable(const robot::Scan& scan) {
  if (scan.ranges_m.size() < 2 || !std::isfinite(scan.step_rad) || scan.step_rad <= 0)
    throw core::ContractError("scan odometry needs scans of at least 2 beams with a positive step");
}

ScanMotion noMotionYet() {
  ScanMotion motion;
  motion.covariance[0] = motion.covariance[4] = motion.covariance[8] = 1e-12;
  return motion;
}

ScanMotion unknownMotion(const ScanOdometryOptions& options) {
  ScanMotion motion;
  motion.reliable = false;
  motion.covariance[0] = motion.covariance[4] = options.max_move_m * options.max_move_m;
  motion.covariance[8] = options.max_turn_rad * options.max_turn_rad;
  return motion;
}

}  // namespace slam::odometry
