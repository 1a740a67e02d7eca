#include "libslam/gridmap/fused_raster.h"

#include <gtest/gtest.h>

namespace slam::gridmap {
namespace {

OccupancyRaster raster(int columns, int rows, double x_min_m, double y_min_m, float value) {
  OccupancyRaster map;
  map.columns = columns, map.rows = rows, map.resolution_m = 0.1;
  map.x_min_m = x_min_m, map.y_min_m = y_min_m;
  map.occupancy.assign(static_cast<size_t>(columns) * rows, value);
  return map;
}

float at(const OccupancyRaster& map, double x_m, double y_m) {
  const int column = map.columnOf(x_m), row = map.rowOf(y_m);
  return map.contains(column, row) ? map.at(column, row) : -1;
}

TEST(FusedRaster, OwnCellsStayAndUnknownOnesAreFilled) {
  OccupancyRaster own = raster(4, 4, 0, 0, 0.5F);
  own.occupancy[0] = 0.1F;  // the cell at the origin
  own.occupancy[3] = 0.9F;  // one that another map calls free
  const OccupancyRaster free = raster(4, 4, 0, 0, 0.2F), sure = raster(4, 4, 0, 0, 0.95F);
  const auto filled = filledFrom(own, {{&free, {0.2, 0, 0}}, {&sure, {0, 0.2, 0}}});
  EXPECT_FLOAT_EQ(at(filled, 0.05, 0.05), 0.1F);
  EXPECT_FLOAT_EQ(at(filled, 0.35, 0.05), 0.9F);
  EXPECT_FLOAT_EQ(at(filled, 0.15, 0.05), 0.5F);   // nobody knows
  EXPECT_FLOAT_EQ(at(filled, 0.55, 0.05), 0.2F);   // beyond its own raster
  EXPECT_FLOAT_EQ(at(filled, 0.35, 0.35), 0.95F);  // the surer of two
}

TEST(FusedRaster, AMapIsTakenFromWhereItLies) {
  OccupancyRaster other = raster(10, 2, 0, 0, 0.5F);
  other.occupancy[9] = 0.99F;  // 0.9 to 1 m ahead of its origin, 0 to 0.1 m to the left
  const auto filled = filledFrom(raster(1, 1, 0, 0, 0.5F), {{&other, {2, 1, core::kPi / 2}}});
  EXPECT_FLOAT_EQ(at(filled, 1.95, 1.95), 0.99F);
  EXPECT_FLOAT_EQ(at(filled, 2.05, 1.95), 0.5F);
}

TEST(FusedRaster, EvidenceOfEqualsAddsUp) {
  const auto a = raster(2, 2, 0, 0, 0.8F), b = raster(2, 2, 0, 0, 0.8F), against = raster(2, 2, 0, 0, 0.2F);
  // Odds of 4 twice are 16.
  EXPECT_NEAR(at(merged({{&a, {}}, {&b, {}}}), 0.05, 0.05), 16.0 / 17.0, 1e-6);
  EXPECT_EQ(at(merged({{&a, {}}, {&against, {}}}), 0.05, 0.05), 0.5F);
  EXPECT_TRUE(merged({}).occupancy.empty());
}

}  // namespace
}  // namespace slam::gridmap
