// Where things lie in a plan: its frames, discs on it, where a robot may start.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "drawn_plan.h"
#include "libslam/core/random.h"
#include "libslam/world/plan.h"

namespace slam::world {
namespace {

TEST(PlanFrames, TakeCellsToTheWorldAndBack) {
  Plan plan = drawnPlan({"#.."}, 0.5);
  plan.T_frame_raster = {10, 20, core::kPi / 2};
  const core::Point2 p = cellsToPoint(plan, {3, 1});
  EXPECT_NEAR(p.x, 10 - 0.5, 1e-12);  // rounding of coordinates of 20 m
  EXPECT_NEAR(p.y, 20 + 1.5, 1e-12);
  const core::Point2 cell = pointToCells(plan, p);
  EXPECT_NEAR(cell.x, 3, 1e-12);
  EXPECT_NEAR(cell.y, 1, 1e-12);
}

TEST(Disc, TouchesTheNearestPointOfACell) {
  const Plan plan = drawnPlan({".......", ".......", "...#...", ".......", "......."});
  EXPECT_TRUE(discCollides(plan, {3.5, 2.5}, 0)) << "inside";
  EXPECT_FALSE(discCollides(plan, {1.5, 2.5}, 1.49));
  EXPECT_TRUE(discCollides(plan, {1.5, 2.5}, 1.5)) << "touching a face counts";
  EXPECT_TRUE(discCollides(plan, {5.5, 2.5}, 1.5));
  // The corner (3, 2) from (2.25, 1.0): 0.75 and 1.0 away, 1.25 in all.
  EXPECT_FALSE(discCollides(plan, {2.25, 1.0}, 0.999));
  EXPECT_FALSE(discCollides(drawnPlan({".....", ".....", "...#.", ".....", "....."}), {1.75, 1.5}, 1.34));
  EXPECT_TRUE(discCollides(drawnPlan({".....", ".....", "...#.", ".....", "....."}), {1.75, 1.5}, 1.36))
      << "hypot(1.25, 0.5) = 1.346";
}

TEST(Disc, CollidesWhereItLeavesThePlan) {
  const Plan plan = drawnPlan({"....", "....", "....", "...."});
  EXPECT_FALSE(discCollides(plan, {2, 2}, 2));
  EXPECT_TRUE(discCollides(plan, {2, 2}, 2.001));
  EXPECT_TRUE(discCollides(plan, {-1, 2}, 0.5));
  EXPECT_TRUE(discCollides(plan, {1e300, 2}, 0.5));
  EXPECT_TRUE(discCollides(plan, {std::numeric_limits<double>::quiet_NaN(), 2}, 0.5));
}

TEST(Disc, AgreesWithEveryCellOfThePlan) {
  core::RandomStream random(9, "discs");
  Plan plan = drawnPlan(std::vector<std::string>(20, std::string(30, '.')), 0.05);
  for (auto& cell : plan.cells) cell = random.below(40) == 0 ? Cell::kOccupied : Cell::kFree;
  int collisions = 0;
  for (int i = 0; i < 5000; ++i) {
    const core::Point2 c{random.uniform(0, 1.5), random.uniform(0, 1)};
    const double radius = random.uniform(0, 0.3);
    bool expected = c.x < radius || c.y < radius || c.x + radius > 1.5 || c.y + radius > 1;
    for (int row = 0; row < plan.rows; ++row)
      for (int column = 0; column < plan.columns; ++column) {
        const double x = std::min(std::max(c.x, column * 0.05), (column + 1) * 0.05);
        const double y = std::min(std::max(c.y, row * 0.05), (row + 1) * 0.05);
        expected =
            expected || (plan.at(column, row) == Cell::kOccupied && std::hypot(x - c.x, y - c.y) <= radius);
      }
    EXPECT_EQ(discCollides(plan, c, radius), expected) << i;
    collisions += expected;
  }
  EXPECT_GT(collisions, 1000);
  EXPECT_LT(collisions, 4500);
}

TEST(StartPose, LiesAtTheMiddleOfTheLargestRegionWithItsClearance) {
  const Plan plan = drawnPlan({"###########",  //
                               "#..#......#",  //
                               "#..#......#",  //
                               "#..#......#",  //
                               "#..#......#",  //
                               "#..#......#",  //
                               "###########"});
  const auto pose = findStartPose(plan, 0.4);
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->x, 6.5) << "of the two middle columns 6 and 7 the first";
  EXPECT_EQ(pose->y, 3.5);
  EXPECT_EQ(pose->phi, 0);
  EXPECT_TRUE(findStartPose(plan, 2.4));
  EXPECT_FALSE(findStartPose(plan, 2.6)) << "the room is 5 wide";
  EXPECT_FALSE(findStartPose(drawnPlan({"#?"}), 0.1)) << "unknown is not free";
  EXPECT_FALSE(findStartPose(plan, std::numeric_limits<double>::quiet_NaN()));
}

TEST(StartPose, CountsOnlyCellsThatTheDiscReaches) {
  // Left a wide hall, right more free cells in a comb of passages one cell wide.
  const Plan plan = drawnPlan({"##################",  //
                               "#.....#..........#",  //
                               "#.....#.########.#",  //
                               "#.....#..........#",  //
                               "#.....#.########.#",  //
                               "#.....#..........#",  //
                               "##################"});
  EXPECT_GT(findStartPose(plan, 0.3)->x, 7);
  EXPECT_LT(findStartPose(plan, 0.9)->x, 6);
}

TEST(StartPose, IsNearestToTheCentreOfMassAmongCellsThatTheDiscFits) {
  Plan plan = drawnPlan(std::vector<std::string>(60, std::string(80, '.')), 0.05);
  plan.T_frame_raster = {-3, 7, 0.7};
  core::RandomStream random(5, "start");
  for (auto& cell : plan.cells) cell = random.below(150) == 0 ? Cell::kOccupied : Cell::kFree;
  for (const double clearance_m : {0.0, 0.05, 0.12, 0.2}) {
    const auto pose = findStartPose(plan, clearance_m);
    ASSERT_TRUE(pose) << clearance_m;
    EXPECT_FALSE(discCollides(plan, core::position(*pose), clearance_m));
    EXPECT_EQ(pose->phi, 0);
    // Few obstacles: nearly all cells are in one region, so its middle is near the plan's middle (40, 30).
    const core::Point2 cell = pointToCells(plan, core::position(*pose));
    EXPECT_LT(std::hypot(cell.x - 40, cell.y - 30), 8) << clearance_m;
  }
}

}  // namespace
}  // namespace slam::world
