#pragma once
#include <vector>

#include "libslam/robot/scan.h"

namespace slam::scanmatch {

/// A return and the surface that it lies on, robot frame.
struct SurfacePoint {
  core::Point2 p;
  core::Point2 n;  ///< unit normal, towards the lidar; (0, 0) where the neighbours tell no direction
};

struct ScanPointOptions {
  double spacing_m = 0.05;  ///< two points of one scan are at least this far apart
  double max_range_m = 40;  ///< farther returns are left out: their spots are wide and their normals unknown
  double normal_reach_m =
      0.4;  ///< neighbours within this belong to the surface; two to twenty beams to each side
};

/// The returns of a scan, thinned to `spacing_m` along the beams: near surfaces, which a scan samples far more
/// densely than the map can use, would outvote far ones.
std::vector<SurfacePoint> surfacePoints(const robot::Scan& scan, const ScanPointOptions& options);

/// The same points without their normals.
std::vector<core::Point2> thinnedPoints(const robot::Scan& scan, const ScanPointOptions& options);

}  // namespace slam::scanmatch
