#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "libslam/core/parameters.h"
#include "libslam/core/pose2.h"
#include "libslam/robot/scan.h"

namespace mrpt::obs {
class CActionRobotMovement2D;
}

namespace slam::odometry {

/// A motion estimated from two scans.
struct ScanMotion {
  core::Pose2 T_previous_current;      ///< of the robot
  std::array<double, 9> covariance{};  ///< row-major over (x, y, phi): m^2, m rad, rad^2; positive definite
  bool reliable = true;                ///< false: too few returns or an ambiguous fit; the motion is a guess
  /// What the founding document logs: `turn` or the two move readings.
  double turn_reading_rad = 0, rear_reading_m = 0, front_reading_m = 0;
};

/// Section [scan_odometry].
struct ScanOdometryOptions {
  std::string method;   ///< argmax | correlation
  double max_turn_rad;  ///< search range between two scans
  double max_move_m;
  ScanOdometryOptions();
  static const core::ParameterTable<ScanOdometryOptions>& table();
};

/// Odometry from consecutive scans alone.
class ScanOdometry {
 public:
  virtual ~ScanOdometry() = default;
  /// Motion since the scan before; the first scan gives the identity with tiny covariance.
  virtual ScanMotion update(const robot::Scan& scan) = 0;
  virtual void reset() = 0;
};

std::unique_ptr<ScanOdometry> makeScanOdometry(const ScanOdometryOptions& options);
std::vector<std::string> scanOdometryNames();

/// As an MRPT action of kind emScan2DMatching, whose covariance MRPT's builders accept.
std::shared_ptr<mrpt::obs::CActionRobotMovement2D> toMrptAction(const ScanMotion& motion, double time_s);

}  // namespace slam::odometry
