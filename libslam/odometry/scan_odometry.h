#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/files/parameters.h"
#include "libslam/lidar/scan.h"
#include "libslam/robot/motion_kind.h"

namespace mrpt::obs {
class CActionRobotMovement2D;
}

namespace slam::odometry {

/// A motion estimated from two scans.
struct ScanMotion {
  core::Pose2 T_previous_current;      ///< of the robot
  std::array<double, 9> covariance{};  ///< row-major over (x, y, phi): m^2, m rad, rad^2; positive definite
  bool reliable = true;                ///< false: too few returns or an ambiguous fit; the motion is a guess
  /// What the original document logs: `t` with the turn, or `m` with the two move readings. Each is a reading
  /// of the scan before minus one of the scan after: the turn is positive counter-clockwise; on a move ahead
  /// the front reading is positive (the wall ahead came nearer) and the rear one negative. 0 where there is
  /// no reading. A method that estimates the whole motion fills in what ideal readings would have been. Of a
  /// command with scans in between (argmax): the readings of all of it so far. An arc has all three.
  double turn_reading_rad = 0, rear_reading_m = 0, front_reading_m = 0;
};

using robot::Commanded;
using robot::MotionKind;

/// Section [scan_odometry].
struct ScanOdometryOptions {
  std::string method;   ///< argmax | argmax_blind | correlation | range_flow | plicp
  double max_turn_rad;  ///< search range between two scans (correlation); what a guess may be wrong by (both)
  double max_move_m;    ///< the same for the translation
  ScanOdometryOptions();
  static const files::ParameterTable<ScanOdometryOptions>& table();
};

/// Odometry from consecutive scans alone.
class ScanOdometry {
 public:
  virtual ~ScanOdometry() = default;
  /// Motion since the scan before; the first scan gives the identity with tiny covariance. `commanded` is for
  /// argmax, which reads a turn and a move differently; the others ignore it. REQUIRES at least 2 beams and a
  /// finite, positive step (ContractError).
  virtual ScanMotion update(const lidar::Scan& scan, const Commanded& commanded) = 0;
  ScanMotion update(const lidar::Scan& scan) { return update(scan, MotionKind::kUnknown); }
  /// Forgets the scan before.
  virtual void reset() = 0;
};

/// Unknown method: InputError with the nearest known one.
std::unique_ptr<ScanOdometry> makeScanOdometry(const ScanOdometryOptions& options);
std::vector<std::string> scanOdometryNames();

/// As an MRPT action of kind emScan2DMatching: mean and covariance as they are, and beside them a Gaussian
/// motion model of about the same spread, because MRPT's particle filters drop the covariance of a 2D action,
/// add up the means of several steps and spread the sum by `motionModelConfiguration` (which MRPT does not
/// write into files). time_s is seconds since the Unix epoch.
std::shared_ptr<mrpt::obs::CActionRobotMovement2D> toMrptAction(const ScanMotion& motion, double time_s);

}  // namespace slam::odometry
