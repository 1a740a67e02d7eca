#include "libslam/results/map_plan.h"

namespace slam::results {

world::Plan toPlan(const gridmap::OccupancyRaster& map) {
  world::Plan plan;
  plan.columns = map.columns;
  plan.rows = map.rows;
  plan.resolution_m = map.resolution_m;
  plan.T_world_plan = {map.x_min_m, map.y_min_m, 0};
  plan.cells.reserve(map.occupancy.size());
  for (const float p : map.occupancy)
    plan.cells.push_back(p > gridmap::kOccupiedAbove ? world::Cell::kOccupied
                         : p < gridmap::kFreeBelow   ? world::Cell::kFree
                                                     : world::Cell::kUnknown);
  return plan;
}

}  // namespace slam::results
