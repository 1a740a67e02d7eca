#pragma once
#include "libslam/gridmap/occupancy_raster.h"
#include "libslam/world/plan.h"

namespace slam::results {

/// An estimated map as a plan in the map frame, as it is written to map.png: occupied above
/// gridmap::kOccupiedAbove, free below kFreeBelow, unknown between.
world::Plan toPlan(const gridmap::OccupancyRaster& map);

}  // namespace slam::results
