#pragma once
#include <cmath>
#include <limits>
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::lidar {

/// Reading of a beam that met nothing up to the maximum range (as ROS REP 117: +infinity).
inline constexpr float kNoReturn = std::numeric_limits<float>::infinity();
/// Reading of a beam that was lost (drop-out) or is invalid for another reason (as ROS REP 117: NaN).
inline constexpr float kLostReading = std::numeric_limits<float>::quiet_NaN();

/// A reading that is a distance to something.
inline bool isReturn(float range_m) {
  return std::isfinite(range_m) && range_m > 0;
}

/// How a spinning lidar measures its beams one after the other.
struct Sweep {
  double duration_s = 0;   ///< from the first to the last beam of the scan
  bool clockwise = false;  ///< the last beam of the scan is measured first
  double stamped_share =
      1;  ///< of the sweep that is over at the scan's stamp: 1 its end (as here), 0 its start (as ROS)
};

/// By what a scan was deskewed.
struct Deskewing {
  Sweep sweep;                   ///< duration 0: it was not
  core::Pose2 T_previous_robot;  ///< m, rad: the robot at the stamp, in its frame period_s before
  double period_s = 0;           ///< in which it moved so
  bool is_measured = true;       ///< else nobody knows: that it went on as before, or stood, was assumed
};

/// One sweep of a 2D lidar. Beam i points to first_angle_rad + i * step_rad in the lidar frame (0 is straight
/// ahead, counter-clockwise positive), so n beams span (n - 1) * step_rad.
struct Scan {
  double time_s = 0;  ///< seconds since the Unix epoch
  double first_angle_rad = 0;
  double step_rad = 0;  ///< positive
  double min_range_m = 0;
  double max_range_m =
      0;  ///< always finite and positive, also for a lidar without a limit (then the world's size)
  double range_sigma_m = 0;     ///< standard deviation of one range, as the sensor states it
  core::Pose2 T_robot_lidar;    ///< mounting pose
  Deskewing deskewing;          ///< by what motion this scan was set right, if any
  std::vector<float> ranges_m;  ///< distance, kNoReturn or kLostReading

  double angle(size_t beam) const { return first_angle_rad + static_cast<double>(beam) * step_rad; }
  /// True when the beams go all the way round: the next beam after the last would be the first again.
  bool isFullCircle() const {
    return std::abs(static_cast<double>(ranges_m.size()) * step_rad - 2 * core::kPi) < 0.5 * step_rad;
  }
};

/// Whether two scans come from one lidar of the robot: each is known by its mounting, to a millimetre and a
/// step between beams. A lidar that gives 180 and 181 beams by turns heads half a step aside at times, as its
/// beams are counted from the middle.
bool areOfOneLidar(const Scan& a, const Scan& b);

/// The points of all returns, in the robot frame, in beam order.
std::vector<core::Point2> scanPoints(const Scan& scan);

}  // namespace slam::lidar
