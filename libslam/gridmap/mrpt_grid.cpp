#include "libslam/gridmap/mrpt_grid.h"

#include <mrpt/maps/COccupancyGridMap2D.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>

namespace slam::gridmap {

OccupancyRaster fromMrpt(const mrpt::maps::COccupancyGridMap2D& grid) {
  OccupancyRaster raster;
  raster.columns = static_cast<int>(grid.getSizeX());
  raster.rows = static_cast<int>(grid.getSizeY());
  raster.resolution_m = std::round(static_cast<double>(grid.getResolution()) * 1e6) / 1e6;
  raster.x_min_m = static_cast<double>(grid.getXMin());
  raster.y_min_m = static_cast<double>(grid.getYMin());
  raster.occupancy.reserve(grid.getRawMap().size());
  using Grid = mrpt::maps::COccupancyGridMap2D;
  using LogOdds = std::decay_t<decltype(grid.getRawMap().front())>;
  const auto occupancyOf = [](LogOdds log_odds) { return log_odds == 0 ? 0.5F : 1.0F - Grid::l2p(log_odds); };
  if constexpr (sizeof(LogOdds) > 1) {
    for (const auto log_odds : grid.getRawMap()) raster.occupancy.push_back(occupancyOf(log_odds));
  } else {
    // Of the few values that there are, each is asked once.
    std::array<float, 256> occupancy{};
    for (int value = -128; value < 128; ++value)
      occupancy[static_cast<std::uint8_t>(value)] = occupancyOf(static_cast<LogOdds>(value));
    for (const auto log_odds : grid.getRawMap())
      raster.occupancy.push_back(occupancy[static_cast<std::uint8_t>(log_odds)]);
  }
  return raster;
}

}  // namespace slam::gridmap
