#include "libslam/rays/ray_walk.h"
#include "libslam/core/numbers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "libslam/core/random.h"
#include "libslam/rays/ray_caster.h"
#include "tests/world/drawn_plan.h"

namespace slam::rays {
namespace {

using core::kInfinity;

/// A cell that a walk entered.
struct Visit {
  int column, row;
  double distance;
};

std::vector<Visit> visits(const world::Plan& plan, const core::Point2& origin, const core::Point2& direction,
                          double limit = kInfinity) {
  std::vector<Visit> all;
  walkRay(plan, origin, direction, limit, [&](const world::Cell* cell, const RayEntry& entry) {
    const auto index = static_cast<int>(cell - plan.cells.data());
    all.push_back({index % plan.columns, index / plan.columns, entry.distance()});
    return *cell != world::Cell::kOccupied;
  });
  return all;
}

/// "column,row" of the visits, in order.
std::string path(const std::vector<Visit>& all) {
  std::string text;
  for (const auto& visit : all) text += std::to_string(visit.column) + "," + std::to_string(visit.row) + " ";
  return text;
}

TEST(RayWalk, EntersTheCellsInOrderUpToTheWall) {
  const world::Plan plan = world::drawnPlan({"...#.",  //
                                             ".....",  //
                                             "....."});
  EXPECT_EQ(path(visits(plan, {0.5, 0.5}, {0.8, 0.6})), "0,0 1,0 1,1 2,1 2,2 3,2 ");
  EXPECT_EQ(path(visits(plan, {2.9, 2.05}, {-0.8, -0.6})), "2,2 2,1 1,1 1,0 0,0 ");  // to the plan's edge
  EXPECT_EQ(path(visits(plan, {1.5, 0.5}, {0, 1})), "1,0 1,1 1,2 ");
}

TEST(RayWalk, VisitsNothingFromOutside) {
  const world::Plan plan = world::drawnPlan({"...", "..."});
  for (const core::Point2 origin : {core::Point2{-0.1, 1}, {1, 2.1}, {std::nan(""), 1}})
    EXPECT_EQ(path(visits(plan, origin, {1, 0})), "");
  EXPECT_EQ(path(visits(plan, {1, 1}, {std::nan(""), 1})), "");
}

TEST(RayWalk, EntersEveryCellOnItsFaceAndEndsWhereTheRayCastEnds) {
  core::RandomStream random(5, "walk");
  world::Plan plan = world::drawnPlan(std::vector<std::string>(40, std::string(60, '.')));
  for (auto& cell : plan.cells)
    if (random.chance(0.02)) cell = world::Cell::kOccupied;
  for (int i = 0; i < 2000; ++i) {
    const core::Point2 origin{random.uniform(0, 60), random.uniform(0, 40)};
    const double angle = random.uniform(-4, 4);
    const core::Point2 direction{std::cos(angle), std::sin(angle)};
    const auto all = visits(plan, origin, direction);
    const double range = castRayInCells(plan, origin, direction);
    ASSERT_FALSE(all.empty());
    EXPECT_EQ(all.front().distance, 0);
    const bool hit = plan.at(all.back().column, all.back().row) == world::Cell::kOccupied;
    EXPECT_EQ(hit ? all.back().distance : kInfinity, range);
    for (size_t k = 1; k < all.size(); ++k) {
      EXPECT_EQ(std::abs(all[k].column - all[k - 1].column) + std::abs(all[k].row - all[k - 1].row), 1);
      EXPECT_GE(all[k].distance, all[k - 1].distance - 1e-12);  // rounding where it grazes a corner
      const core::Point2 p{origin.x + all[k].distance * direction.x,
                           origin.y + all[k].distance * direction.y};
      // On the face between the two cells, but for the rounding of numbers up to 60.
      EXPECT_NEAR(p.x, all[k].column + 0.5, 0.5 + 1e-9);
      EXPECT_NEAR(p.y, all[k].row + 0.5, 0.5 + 1e-9);
      EXPECT_NEAR(p.x, all[k - 1].column + 0.5, 0.5 + 1e-9);
      EXPECT_NEAR(p.y, all[k - 1].row + 0.5, 0.5 + 1e-9);
    }
  }
}

TEST(RayWalk, ALimitEndsItAtMostTwoColumnsLate) {
  const world::Plan plan = world::drawnPlan({std::string(30, '.')});
  for (const double limit : {0.0, 0.4, 0.6, 3.0, 7.7}) {
    const auto all = visits(plan, {0.5, 0.5}, {1, 0}, limit);
    int within = 0;
    walkRay(plan, {0.5, 0.5}, {1, 0}, limit, [&](const world::Cell*, const RayEntry& entry) {
      EXPECT_EQ(entry.isWithin(limit), entry.distance() <= limit);
      within += entry.isWithin(limit);
      return true;
    });
    EXPECT_EQ(within, 1 + std::lround(limit));
    EXPECT_LE(static_cast<int>(all.size()), within + 2);
  }
}

}  // namespace
}  // namespace slam::rays
