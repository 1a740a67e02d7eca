#pragma once
#include <vector>

#include "libslam/lidar/scan.h"

namespace slam::scanmatch {

/// A return and the surface that it lies on, robot frame.
struct SurfacePoint {
  core::Point2 p;
  core::Point2 n;  ///< unit normal, towards the lidar; (0, 0) where the neighbours tell no direction
};

struct ScanPointOptions {
  double spacing_m = 0.05;  ///< two points of one scan are about this far apart at least
  double max_range_m = 40;  ///< farther returns are left out: their spots are wide and their normals unknown
  double normal_reach_m =
      0.4;  ///< neighbours within this belong to the surface; two to twenty beams to each side
};

/// The returns of a scan, thinned to `spacing_m` along the beams: near surfaces, which a scan samples far
/// more densely than the map can use, would outvote far ones.
std::vector<SurfacePoint> surfacePoints(const lidar::Scan& scan, const ScanPointOptions& options);

/// A return, robot frame (m), and the piece of surface that it stands for, from half way to the beam before
/// to half way to the beam behind: its standard deviation along the surface. Far along a wall beams strike
/// metres apart, and where between two of them a wall was struck says nothing of the wall. Where no neighbour
/// lies on the same surface: what the beams leave open sideways. The lidar is on the left of `along`:
/// (-along_y, along_x) points to its side.
struct PatchPoint {
  float x = 0, y = 0;
  float along_x = 0, along_y = 0;
};
core::Point2 position(const PatchPoint& point);
PatchPoint operator*(const core::Pose2& T_a_b, const PatchPoint& point_b);

/// The same points with their patches instead of normals.
std::vector<PatchPoint> patchPoints(const lidar::Scan& scan, const ScanPointOptions& options);

}  // namespace slam::scanmatch
