#include "libslam/gridmap/mrpt_grid.h"

#include <mrpt/maps/COccupancyGridMap2D.h>

#include <cmath>

namespace slam::gridmap {

OccupancyRaster fromMrpt(const mrpt::maps::COccupancyGridMap2D& grid) {
  OccupancyRaster raster;
  raster.columns = static_cast<int>(grid.getSizeX());
  raster.rows = static_cast<int>(grid.getSizeY());
  raster.resolution_m = std::round(static_cast<double>(grid.getResolution()) * 1e6) / 1e6;
  raster.x_min_m = static_cast<double>(grid.getXMin());
  raster.y_min_m = static_cast<double>(grid.getYMin());
  raster.occupancy.reserve(grid.getRawMap().size());
  for (const auto log_odds : grid.getRawMap())
    raster.occupancy.push_back(log_odds == 0 ? 0.5F : 1.0F - mrpt::maps::COccupancyGridMap2D::l2p(log_odds));
  return raster;
}

}  // namespace slam::gridmap
