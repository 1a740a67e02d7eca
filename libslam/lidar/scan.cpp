#include "libslam/lidar/scan.h"

#include <algorithm>
#include <cmath>

namespace slam::lidar {
namespace {

/// Mountings that logs repeat with every scan differ by their digits.
constexpr double kSamePlace_m = 1e-3, kSameHeading_rad = 1e-3;

}  // namespace

std::vector<core::Point2> scanPoints(const Scan& scan) {
  std::vector<core::Point2> points;
  points.reserve(scan.ranges_m.size());
  for (size_t i = 0; i < scan.ranges_m.size(); ++i) {
    if (!isReturn(scan.ranges_m[i])) continue;
    const double range_m = scan.ranges_m[i], angle_rad = scan.angle(i);
    points.push_back(scan.T_robot_lidar * core::polar(range_m, angle_rad));
  }
  return points;
}

bool areOfOneLidar(const Scan& scan_a, const Scan& scan_b) {
  const core::Pose2 &a = scan_a.T_robot_lidar, &b = scan_b.T_robot_lidar;
  return core::distance(a, b) < kSamePlace_m &&
         std::abs(core::angleDifference(a.phi, b.phi)) < std::max(kSameHeading_rad, scan_a.step_rad);
}

}  // namespace slam::lidar
