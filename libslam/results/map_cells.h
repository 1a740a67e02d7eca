#pragma once
#include "libslam/gridmap/occupancy_raster.h"
#include "libslam/world/cell_map.h"

namespace slam::results {

/// An estimated map by what its cells are taken for, in the map frame, as it is written to map.png: occupied
/// above gridmap::kOccupiedAbove, free below kFreeBelow, unknown between.
world::CellMap toCellMap(const gridmap::OccupancyRaster& map);

}  // namespace slam::results
