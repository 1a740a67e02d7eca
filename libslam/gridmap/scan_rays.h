#pragma once
#include <vector>

#include "libslam/lidar/scan.h"

namespace slam::gridmap {

/// What one beam says about the place: nothing up to `end`, and with `hit` a surface there; robot frame.
struct Ray {
  core::Point2 end;
  bool hit = false;
  /// Of the surface: towards the side that it is seen from, of any length; (0, 0): not told.
  core::Point2 normal;
};

/// A scan as straight lines from one point, all in the robot frame.
struct ScanRays {
  core::Point2 origin;
  std::vector<Ray> rays;  ///< in beam order, without the beams that say nothing
};

struct RayOptions {
  double max_range_m = 30;        ///< farther returns clear up to here and mark nothing
  bool no_return_is_free = true;  ///< a beam that met nothing clears as far as the lidar sees, or max_range_m
};

/// Returns nearer to each other than this lie on one surface.
inline constexpr double kOneSurface_m = 0.4;

/// Beam i points exactly to scan.angle(i) in the lidar frame: n beams span n - 1 steps. A lost reading (NaN)
/// says nothing, neither does one that is not positive. A surface's normal is that of the line through the
/// returns beside it, when they are less than kOneSurface_m apart, else the way back along the beam.
ScanRays scanRays(const lidar::Scan& scan, const RayOptions& options);

}  // namespace slam::gridmap
