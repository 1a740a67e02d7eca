#include "libslam/gridmap/scan_rays.h"

#include <algorithm>

#include "libslam/core/elementary.h"

namespace slam::gridmap {
namespace {

/// Of a surface, towards the lidar.
core::Point2 normalOf(const ScanRays& scan, size_t i) {
  const std::vector<Ray>& rays = scan.rays;
  const core::Point2 back{scan.origin.x - rays[i].end.x, scan.origin.y - rays[i].end.y};
  if (i == 0 || i + 1 == rays.size() || !rays[i - 1].hit || !rays[i + 1].hit) return back;
  const core::Point2 &a = rays[i - 1].end, &b = rays[i + 1].end;
  if (!core::areWithin(a, b, kOneSurface_m)) return back;
  const core::Point2 normal{a.y - b.y, b.x - a.x};
  return normal.x * back.x + normal.y * back.y >= 0 ? normal : core::Point2{-normal.x, -normal.y};
}

}  // namespace

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
                           is_return && range_m <= options.max_range_m,
                           {}});
  }
  for (size_t i = 0; i < result.rays.size(); ++i)
    if (result.rays[i].hit) result.rays[i].normal = normalOf(result, i);
  return result;
}

}  // namespace slam::gridmap
