#include "libslam/world/shortest_path.h"

#include <gtest/gtest.h>

#include <cmath>

namespace slam::world {
namespace {

/// Free cells of 0.1 m, with a wall two cells thick at column 20 from below up to `height` rows.
Plan walled(int height) {
  Plan plan;
  plan.columns = 40;
  plan.rows = 30;
  plan.resolution_m = 0.1;
  plan.cells.assign(1200, Cell::kFree);
  for (int row = 0; row < height; ++row)
    plan.cells[static_cast<size_t>(row) * 40 + 20] = plan.cells[static_cast<size_t>(row) * 40 + 21] =
        Cell::kOccupied;
  return plan;
}

TEST(ShortestPath, IsTheStraightLineWhereNothingStands) {
  const auto path = shortestPath(walled(0), {0.52, 0.47}, {3.41, 2.13}, 0.2, 0.05);
  ASSERT_TRUE(path.has_value());
  const double direct_m = std::hypot(3.41 - 0.52, 2.13 - 0.47);
  EXPECT_GE(path->length_m, direct_m - 0.05);  // it ends within the tolerance
  EXPECT_LE(path->length_m, direct_m + 0.05);  // at the centre of a cell there
}

TEST(ShortestPath, GoesRoundAWallWithRoomForTheDisc) {
  const auto path = shortestPath(walled(15), {1.05, 0.55}, {3.05, 0.55}, 0.25, 0.01);
  ASSERT_TRUE(path.has_value());
  // Tangents to the arcs of radius 0.25 m about the corners (2.0, 1.5) and (2.2, 1.5).
  const double reach_m = std::hypot(0.95, 0.95), tangent_m = std::sqrt(reach_m * reach_m - 0.0625);
  // The second corner lies 0.85 m from the end: bounds are enough, 4 % for the grid.
  const double least_m = tangent_m + 0.2 + std::sqrt(0.85 * 0.85 + 0.95 * 0.95 - 0.0625);
  EXPECT_GE(path->length_m, least_m);
  EXPECT_LE(path->length_m, 1.04 * (least_m + 0.25 * core::kPi));
}

TEST(ShortestPath, SaysWhenThereIsNone) {
  EXPECT_FALSE(shortestPath(walled(30), {1, 1}, {3, 1}, 0.1, 0.1).has_value());   // cut off
  EXPECT_FALSE(shortestPath(walled(26), {1, 1}, {3, 1}, 0.25, 0.1).has_value());  // a gap of 0.4 m
  EXPECT_TRUE(shortestPath(walled(26), {1, 1}, {3, 1}, 0.15, 0.1).has_value());
  EXPECT_FALSE(shortestPath(walled(10), {2.1, 0.5}, {3, 1}, 0.1, 0.1).has_value());  // starts in the wall
  EXPECT_FALSE(shortestPath(walled(10), {9, 9}, {3, 1}, 0.1, 0.1).has_value());      // outside
  EXPECT_FALSE(shortestPath(walled(10), {1, 1}, {9, 9}, 0.1, 0.1).has_value());
}

TEST(ShortestPath, IsNothingFromThereToThere) {
  const auto path = shortestPath(walled(10), {1, 1}, {1.05, 1}, 0.2, 0.1);
  ASSERT_TRUE(path.has_value());
  EXPECT_EQ(path->length_m, 0);
}

}  // namespace
}  // namespace slam::world
