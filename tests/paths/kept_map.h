#pragma once
#include <cstddef>
#include <utility>

#include "libslam/core/random.h"
#include "libslam/gridmap/occupancy_raster.h"

namespace slam::paths {

/// Unknown all over.
inline gridmap::OccupancyRaster unknownRaster(int columns, int rows) {
  gridmap::OccupancyRaster map;
  map.columns = columns, map.rows = rows;
  map.resolution_m = 0.05;
  map.occupancy.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0.5F);
  return map;
}

/// `count` cells of all kinds in the columns and rows from `first` up to `last`.
inline void strew(gridmap::OccupancyRaster& map, std::pair<int, int> first, std::pair<int, int> last,
                  int count, core::RandomStream& random) {
  for (int i = 0; i < count; ++i) {
    const auto column = static_cast<int>(random.uniform(first.first, last.first));
    const auto row = static_cast<int>(random.uniform(first.second, last.second));
    const double kind = random.uniform(0, 4);  // half of them free
    map.occupancy[static_cast<std::size_t>(row) * map.columns + column] =
        kind < 2 ? 0.1F : (kind < 3 ? 0.9F : 0.5F);
  }
}

}  // namespace slam::paths
