#include "libslam/results/map_cells.h"

#include <gtest/gtest.h>

namespace slam::results {
namespace {

using world::Cell;

TEST(ToCellMap, TakesSureCellsForFreeOrOccupiedWhereTheyLie) {
  gridmap::OccupancyRaster map;
  map.columns = 3, map.rows = 2;
  map.resolution_m = 0.1;
  map.x_min_m = -1, map.y_min_m = 2;
  map.occupancy = {0.F, 0.5F, 1.F, gridmap::kFreeBelow, gridmap::kOccupiedAbove, 0.9F};
  const world::CellMap cells = toCellMap(map);
  EXPECT_EQ(cells.columns, 3);
  EXPECT_EQ(cells.rows, 2);
  EXPECT_EQ(cells.cells, (std::vector<Cell>{Cell::kFree, Cell::kUnknown, Cell::kOccupied, Cell::kUnknown,
                                            Cell::kUnknown, Cell::kOccupied}));
  const auto p = world::cellsToPoint(cells, {1, 1});
  EXPECT_NEAR(p.x, -0.9, 1e-12);  // a sum of two
  EXPECT_NEAR(p.y, 2.1, 1e-12);
}

}  // namespace
}  // namespace slam::results
