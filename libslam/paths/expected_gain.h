#pragma once
#include <cstddef>
#include <utility>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/lidar/scan.h"
#include "libslam/paths/free_space.h"

namespace slam::paths {

/// What a lidar on the robot would look at from somewhere, taken from one of its scans.
struct LookShape {
  double first_rad = 0;  ///< direction of the first beam in the robot frame
  double fov_rad = 0;    ///< 2 pi for a full circle
  double max_range_m = 0;
  bool full_circle = false;
};
LookShape lookShape(const lidar::Scan& scan);

/// What a look round from a place is expected to show, by direction.
///
/// A ray runs through the map until it meets an occupied cell or the maximum range. An unknown cell holds one
/// bit, a known one none, so the expected entropy reduction is the unknown area that the ray sweeps, in bits
/// or, as here, in square metres (one bit per cell). In the unknown the ray may be stopped by what is not on
/// the map yet: what lies behind s metres of unknown counts exp(-s / unknown_path_m), as with obstacles that
/// are strewn at random. Casting into the map for the expected information follows Stachniss, Grisetti and
/// Burgard, "Information gain-based exploration using Rao-Blackwellized particle filters" (RSS 2005); the
/// damping in the unknown is ours. A ray stands for its whole wedge (area r dr dphi), so no cell is counted
/// twice.
struct GainProfile {
  std::vector<double> area_m2;  ///< direction i is (i + 0.5) * 2 pi / n in the map frame
  /// Of all directions.
  double total() const;
  /// Of those that the lidar covers when the robot heads along heading_rad.
  double within(const LookShape& view, double heading_rad) const;
  /// The heading with the largest within(), of equals the first. Undefined for an empty profile.
  double bestHeading(const LookShape& view) const;
};
GainProfile expectedGain(const FreeSpace& space, const core::Point2& p_map, const LookShape& view,
                         double unknown_path_m, int directions);

/// The same for one heading, cell by cell: (cell, expected area in m^2), a cell once per ray that crosses it.
std::vector<std::pair<std::size_t, float>> expectedCells(const FreeSpace& space, const core::Point2& p_map,
                                                         const LookShape& view, double heading_rad,
                                                         double unknown_path_m, int directions);

}  // namespace slam::paths
