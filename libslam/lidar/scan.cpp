#include "libslam/lidar/scan.h"

namespace slam::lidar {

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
  return a.x == b.x && a.y == b.y && a.phi == b.phi;
}

}  // namespace slam::lidar
