#pragma once
#include <cmath>
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::gridmap {

/// A map as probabilities on a raster, whatever the method holds inside: what a strategy looks at, and what
/// becomes a picture, a ROS map and scores. Cell (column, row) covers [column, column + 1) x [row, row + 1)
/// in units of resolution_m from the lower left corner; row 0 is at the bottom (y up).
struct OccupancyRaster {
  int columns = 0, rows = 0;
  double resolution_m = 0.05;
  double x_min_m = 0, y_min_m = 0;  ///< lower left corner in the map frame
  std::vector<float> occupancy;     ///< row-major from the bottom, 0 free .. 1 occupied, exactly 0.5 unknown

  bool contains(int column, int row) const {
    return column >= 0 && row >= 0 && column < columns && row < rows;
  }
  float at(int column, int row) const { return occupancy[static_cast<size_t>(row) * columns + column]; }
  int columnOf(double x_m) const { return static_cast<int>(std::floor((x_m - x_min_m) / resolution_m)); }
  int rowOf(double y_m) const { return static_cast<int>(std::floor((y_m - y_min_m) / resolution_m)); }
  /// Centre of a cell, map frame.
  core::Point2 centreOf(int column, int row) const {
    return {x_min_m + (column + 0.5) * resolution_m, y_min_m + (row + 0.5) * resolution_m};
  }
};

/// Above and below these a cell counts as occupied and free, between them as unknown.
inline constexpr float kOccupiedAbove = 0.6F, kFreeBelow = 0.4F;

}  // namespace slam::gridmap
