#include "libslam/results/map_cells.h"

namespace slam::results {

world::CellMap toCellMap(const gridmap::OccupancyRaster& map) {
  world::CellMap cell_map;
  cell_map.columns = map.columns;
  cell_map.rows = map.rows;
  cell_map.resolution_m = map.resolution_m;
  cell_map.T_frame_raster = {map.x_min_m, map.y_min_m, 0};
  cell_map.cells.reserve(map.occupancy.size());
  for (const float p : map.occupancy)
    cell_map.cells.push_back(p > gridmap::kOccupiedAbove ? world::Cell::kOccupied
                             : p < gridmap::kFreeBelow   ? world::Cell::kFree
                                                         : world::Cell::kUnknown);
  return cell_map;
}

}  // namespace slam::results
