#include "libslam/rays/wall_hit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/rays/ray_caster.h"
#include "tests/world/drawn_plan.h"

namespace slam::rays {
namespace {

using core::degToRad;
using core::kPi;

TEST(FindWall, NamesCellFaceAndMaterial) {
  const world::Plan plan = world::drawnPlan({"....", "..G.", "...."});
  const auto east = findWall(plan, {0.5, 1.5}, 0);
  ASSERT_TRUE(east);
  EXPECT_EQ(east->distance_m, 1.5);
  EXPECT_EQ(east->leaves_m, 2.5);
  EXPECT_EQ(east->column, 2);
  EXPECT_EQ(east->row, 1);
  EXPECT_EQ(east->face_x, -1);
  EXPECT_EQ(east->face_y, 0);
  EXPECT_EQ(east->material, world::Material::kGlass);
  const auto south = findWall(plan, {2.5, 2.75}, -kPi / 2);
  ASSERT_TRUE(south);
  EXPECT_EQ(south->face_x, 0);
  EXPECT_EQ(south->face_y, 1);
  EXPECT_EQ(south->distance_m, 0.75);
  EXPECT_FALSE(findWall(plan, {0.5, 0.5}, 0));
}

TEST(FindWall, LeavesAWallWhereItsMaterialEnds) {
  const world::Plan plan = world::drawnPlan({".GG#.#"});
  const auto hit = findWall(plan, {0.5, 0.5}, 0);
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->distance_m, 0.5);
  EXPECT_EQ(hit->leaves_m, 2.5);
  const auto from_inside = findWall(plan, {1.5, 0.5}, 0);
  ASSERT_TRUE(from_inside);
  EXPECT_EQ(from_inside->distance_m, 0);
  EXPECT_EQ(from_inside->face_x, 0);
  EXPECT_EQ(from_inside->face_y, 0);
  EXPECT_EQ(findWall(world::drawnPlan({".#"}), {0.5, 0.5}, 0)->leaves_m, INFINITY);
}

TEST(FindWall, IsAsFarAsTheCasterSays) {
  core::RandomStream random(1, "wall hit test");
  world::Plan plan;
  plan.columns = 40, plan.rows = 30, plan.resolution_m = 0.1, plan.T_frame_raster = {3, -2, 0.4};
  for (int i = 0; i < plan.columns * plan.rows; ++i)
    plan.cells.push_back(random.chance(0.05) ? world::Cell::kOccupied : world::Cell::kFree);
  for (int i = 0; i < 2000; ++i) {
    const core::Point2 p = world::cellsToPoint(plan, {random.uniform(0, 40), random.uniform(0, 30)});
    const double angle_rad = random.uniform(-kPi, kPi);
    const auto hit = findWall(plan, p, angle_rad);
    ASSERT_EQ(hit ? hit->distance_m : INFINITY, castRay(plan, p, angle_rad, 0));
    if (hit && hit->distance_m > 0) {
      // The face looks against the ray, one axis at a time.
      EXPECT_EQ(std::abs(hit->face_x) + std::abs(hit->face_y), 1);
      const double angle_in_plan = angle_rad - 0.4;
      EXPECT_LT(hit->face_x * std::cos(angle_in_plan) + hit->face_y * std::sin(angle_in_plan), 0);
    }
  }
}

TEST(IsPlainAt, LooksAtEveryCellThatAPointMayBelongTo) {
  const world::Plan plan = world::drawnPlan({"...", ".G.", "..."});
  EXPECT_FALSE(isPlainAt(plan, {1.5, 1.5}));
  for (const double off : {-1e-6, 0.0, 1e-6}) {
    EXPECT_FALSE(isPlainAt(plan, {1 + off, 1.5})) << off;
    EXPECT_FALSE(isPlainAt(plan, {1.5, 2 + off})) << off;
    EXPECT_FALSE(isPlainAt(plan, {2 + off, 2 + off})) << off;
    EXPECT_TRUE(isPlainAt(plan, {0.5 + off, 2.5})) << off;
  }
  EXPECT_TRUE(isPlainAt(plan, {-1e9, 3.1}));
  EXPECT_TRUE(isPlainAt(world::drawnPlan({"###"}), {1.5, 0.5}));
}

/// The normal where a ray from `origin` hits, degrees in the world.
double normalAt(const world::Plan& plan, const core::Point2& origin, double angle_rad) {
  const auto hit = findWall(plan, origin, angle_rad);
  if (!hit) return NAN;
  const core::Point2 normal = surfaceAt(plan, *hit).normal;
  EXPECT_NEAR(std::hypot(normal.x, normal.y), 1, 1e-15);
  return core::radToDeg(std::atan2(normal.y, normal.x));
}

TEST(SurfaceAt, IsTheFaceOfAWallAlongAnAxis) {
  const world::Plan plan =
      world::drawnPlan({"########", "#......#", "#......#", "#......#", "#..MM..#", "########"});
  for (int i = 0; i < 12; ++i) {
    const double x = 1.25 + 0.5 * i;
    EXPECT_EQ(normalAt(plan, {x, 2.5}, kPi / 2), -90) << x;
    EXPECT_EQ(normalAt(plan, {x, 2.5}, -kPi / 2), 90) << x;
  }
  for (int i = 0; i < 6; ++i) {
    const double y = 2.25 + 0.5 * i;
    EXPECT_EQ(normalAt(plan, {4, y}, 0), 180) << y;
    EXPECT_EQ(normalAt(plan, {4, y}, kPi), 0) << y;
  }
}

TEST(SurfaceAt, IsTheFaceOfThinPanesAndSinglePosts) {
  const world::Plan plan = world::drawnPlan({".......", ".GGGGG.", ".......", "...#...", "......."});
  EXPECT_EQ(normalAt(plan, {1.5, 2.5}, kPi / 2), -90);
  EXPECT_EQ(normalAt(plan, {5.5, 4.5}, -kPi / 2), 90);
  EXPECT_EQ(normalAt(plan, {0.5, 3.5}, 0), 180) << "the pane's end is no staircase";
  EXPECT_EQ(normalAt(plan, {6.5, 3.5}, kPi), 0);
  EXPECT_EQ(normalAt(plan, {0.5, 1.5}, 0), 180);
  EXPECT_EQ(normalAt(plan, {3.5, 0.5}, kPi / 2), -90);
}

TEST(SurfaceAt, KeepsToTheMaterialThatWasHit) {
  // A mirror that stands one cell out of the wall: its frame must not tilt it.
  const world::Plan plan = world::drawnPlan({"##########", "....MMMM..", "..........", ".........."});
  for (int i = 0; i < 8; ++i) EXPECT_EQ(normalAt(plan, {4.25 + 0.5 * i, 0.5}, kPi / 2), -90) << i;
}

TEST(SurfaceAt, TurnsWithThePlan) {
  world::Plan plan = world::drawnPlan({"####", "....", "...."});
  plan.T_frame_raster = {5, 6, degToRad(30)};
  const core::Point2 origin = world::cellsToPoint(plan, {2.5, 0.5});
  EXPECT_NEAR(normalAt(plan, origin, degToRad(120)), -60, 1e-12);
}

/// Occupied below the line through the middle that rises by `slope`.
world::Plan slope(double slope, int side = 120) {
  world::Plan plan;
  plan.columns = plan.rows = side;
  plan.resolution_m = 0.05;
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column)
      plan.cells.push_back(row + 0.5 < 0.5 * side + slope * (column + 0.5 - 0.5 * side)
                               ? world::Cell::kOccupied
                               : world::Cell::kFree);
  return plan;
}

/// The worst error of the normal over the middle of that line, degrees.
double worstNormalError(double rise) {
  const world::Plan plan = slope(rise);
  const double expected_deg = core::radToDeg(std::atan(rise)) + 90;
  double worst_deg = 0;
  for (int i = 0; i < 300; ++i) {
    const double found_deg = normalAt(plan, {1.5 + 0.01 * i, 5.9}, -kPi / 2);
    worst_deg = std::max(worst_deg, std::abs(found_deg - expected_deg));
  }
  return worst_deg;
}

TEST(SurfaceAt, IsExactForSlopesOfOneInN) {
  for (const int n : {1, 2, 3, 5, 8}) EXPECT_NEAR(worstNormalError(1.0 / n), 0, 1e-9) << "1 : " << n;
}

TEST(SurfaceAt, IsWithinADegreeForOtherStraightWalls) {
  double worst_deg = 0;
  for (int i = 0; i < 42; ++i) worst_deg = std::max(worst_deg, worstNormalError(0.005 + 0.0237 * i));
  EXPECT_LT(worst_deg, 1.0);
  EXPECT_GT(worst_deg, 0.1);  // the raster costs something
}

TEST(SurfaceAt, SaysHowFarTheStepsStandOut) {
  EXPECT_EQ(surfaceAt(slope(0), *findWall(slope(0), {3, 5.9}, -kPi / 2)).steps_m, 0);
  EXPECT_NEAR(surfaceAt(slope(0.5), *findWall(slope(0.5), {3, 5.9}, -kPi / 2)).steps_m, 0.075, 1e-12);
}

TEST(SurfaceAt, NeedsAFace) {
  const world::Plan plan = world::drawnPlan({"###"});
  EXPECT_THROW(surfaceAt(plan, *findWall(plan, {1.5, 0.5}, 0)), core::ContractError);
}

}  // namespace
}  // namespace slam::rays
