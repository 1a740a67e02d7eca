#include "libslam/world/cell_map.h"

namespace slam::world {

core::Point2 pointToCells(const CellMap& map, const core::Point2& p_frame) {
  const core::Point2 p_raster = core::inverse(map.T_frame_raster) * p_frame;
  return {p_raster.x / map.resolution_m, p_raster.y / map.resolution_m};
}

core::Point2 cellsToPoint(const CellMap& map, const core::Point2& cell) {
  return map.T_frame_raster * core::Point2{cell.x * map.resolution_m, cell.y * map.resolution_m};
}

}  // namespace slam::world
