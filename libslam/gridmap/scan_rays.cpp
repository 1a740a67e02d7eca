#include "libslam/gridmap/scan_rays.h"

#include <algorithm>

#include "libslam/core/elementary.h"

namespace slam::gridmap {

ScanRays scanRays(const lidar::Scan& scan, const RayOptions& options) {
  ScanRays result;
  result.origin = core::position(scan.T_robot_lidar);
  result.rays.reserve(scan.ranges_m.size());
  const double clear_m = std::min(options.max_range_m, scan.max_range_m);
  for (size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const float reading_m = scan.ranges_m[i];
    const bool is_return = lidar::isReturn(reading_m);
    if (!is_return && !(reading_m == lidar::kNoReturn && options.no_return_is_free)) continue;
    const double range_m = is_return ? static_cast<double>(reading_m) : clear_m;
    const double length_m = std::min(range_m, options.max_range_m);
    const double angle_rad = scan.T_robot_lidar.phi + scan.angle(i);
    result.rays.push_back({{result.origin.x + length_m * core::cos(angle_rad),
                            result.origin.y + length_m * core::sin(angle_rad)},
                           is_return && range_m <= options.max_range_m});
  }
  return result;
}

}  // namespace slam::gridmap
