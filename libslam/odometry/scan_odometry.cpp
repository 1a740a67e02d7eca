#include "libslam/odometry/scan_odometry.h"

#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/odometry/methods.h"

namespace slam::odometry {

ScanOdometryOptions::ScanOdometryOptions() {
  table().setDefaults(*this);
}

const files::ParameterTable<ScanOdometryOptions>& ScanOdometryOptions::table() {
  static const files::ParameterTable<ScanOdometryOptions> rows(
      "scan_odometry", {{"method", &ScanOdometryOptions::method, "correlation", scanOdometryNames(),
                         "argmax: the longest range and two readings, told what was commanded; argmax_blind "
                         "guesses that; the others "
                         "all beams, with covariance: correlation searches every turn, range_flow follows "
                         "the gradients of the ranges, plicp goes on from the step before"},
                        {"max_turn_deg", &ScanOdometryOptions::max_turn_rad, 60.0, 1.0, 180.0,
                         "largest turn between two scans that is searched for"},
                        {"max_move_m", &ScanOdometryOptions::max_move_m, 2.0, 0.01, 100.0,
                         "largest move between two scans that is believed"}});
  return rows;
}

std::vector<std::string> scanOdometryNames() {
  return {"argmax", "argmax_blind", "correlation", "range_flow", "plicp"};
}

std::unique_ptr<ScanOdometry> makeScanOdometry(const ScanOdometryOptions& options) {
  if (options.method == "argmax" || options.method == "argmax_blind") return makeArgmaxOdometry(options);
  if (options.method == "correlation") return makeCorrelationOdometry(options);
  if (options.method == "range_flow") return makeRangeFlowOdometry(options);
  if (options.method == "plicp") return makePlicpOdometry(options);
  throw core::InputError("[scan_odometry] method: found '" + options.method +
                         "', expected argmax, argmax_blind, correlation, range_flow or plicp" +
                         core::didYouMean(options.method, scanOdometryNames()));
}

void requireUsable(const lidar::Scan& scan) {
  if (scan.ranges_m.size() < 2 || !std::isfinite(scan.step_rad) || scan.step_rad <= 0)
    throw core::ContractError("scan odometry needs scans of at least 2 beams with a positive step");
}

ScanMotion robotMotion(const lidar::Scan& before, const lidar::Scan& after, const core::Pose2& T_lidar,
                       const std::array<double, 9>& lidar) {
  const core::Pose2& mount = before.T_robot_lidar;
  ScanMotion motion;
  motion.T_previous_current = mount * T_lidar * core::inverse(after.T_robot_lidar);
  // t_robot = l + R(mount) t_lidar - R(phi) l: its derivative by t_lidar is R(mount), by phi -R'(phi) l.
  const auto [sm, cm] = core::sinCos(mount.phi);
  const auto [s, c] = core::sinCos(T_lidar.phi);
  const double J[3][3] = {
      {cm, -sm, s * mount.x + c * mount.y}, {sm, cm, -c * mount.x + s * mount.y}, {0, 0, 1}};
  for (size_t row = 0; row < 3; ++row)
    for (size_t column = row; column < 3; ++column) {
      double sum = 0;
      for (size_t i = 0; i < 3; ++i)
        for (size_t k = 0; k < 3; ++k) sum += J[row][i] * lidar[3 * i + k] * J[column][k];
      motion.covariance[3 * row + column] = motion.covariance[3 * column + row] = sum;
    }
  motion.turn_reading_rad = motion.T_previous_current.phi;
  motion.front_reading_m = motion.T_previous_current.x;
  motion.rear_reading_m = -motion.T_previous_current.x;
  return motion;
}

bool isMeasurement(const std::array<double, 9>& c) {
  constexpr double kLargestError_m = 0.1, kLargestError_rad = 0.05;
  const double largest = (c[0] + c[4]) / 2 + core::hypot((c[0] - c[4]) / 2, c[1]);
  return largest < kLargestError_m * kLargestError_m && c[8] < kLargestError_rad * kLargestError_rad;
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
