#pragma once
#include "libslam/gridmap/occupancy_raster.h"

namespace mrpt::maps {
class COccupancyGridMap2D;
}

namespace slam::gridmap {

/// The cells of MRPT's grid, of ours or of any other class derived from it. MRPT keeps the probability of
/// being free; a cell whose log-odds are 0, never changed or evenly, is unknown: exactly 0.5. MRPT keeps the
/// resolution as a float: it is taken to the nearest micrometre, 0.05 and not 0.05000000074505806.
OccupancyRaster fromMrpt(const mrpt::maps::COccupancyGridMap2D& grid);

}  // namespace slam::gridmap
