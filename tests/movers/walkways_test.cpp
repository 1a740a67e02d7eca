#include "libslam/movers/walkways.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/sim/two_rooms.h"

namespace slam::movers {
namespace {

constexpr double kRadius_m = 0.25;

void shut(world::Plan& plan, world::Cell cell) {
  const auto& door = plan.doors.front();
  for (int row = door.y0; row < door.y1; ++row)
    for (int column = door.x0; column < door.x1; ++column)
      plan.cells[static_cast<size_t>(row) * plan.columns + column] = cell;
}

/// Random walls of single cells, and some unknown ones.
world::Plan scattered() {
  world::Plan plan = sim::twoRooms();
  core::RandomStream random(4, "walls");
  for (auto& cell : plan.cells)
    if (const double draw = random.uniform(); draw < 0.005)
      cell = world::Cell::kOccupied;
    else if (draw < 0.01)
      cell = world::Cell::kUnknown;
  plan.doors.clear();
  return plan;
}

TEST(Walkways, LetNobodyStandWhereTheDiscCollides) {
  const world::Plan plan = scattered();
  const Walkways walkways(plan, kRadius_m, 1, {3, 3});
  core::RandomStream random(1, "points");
  const double half_diagonal_m = plan.resolution_m * std::sqrt(0.5);
  int standing = 0;
  for (int i = 0; i < 100000; ++i) {
    const core::Point2 p{random.uniform(-0.5, 12.5), random.uniform(-0.5, 6.5)};
    const auto column = static_cast<int>(std::floor(p.x / plan.resolution_m)),
               row = static_cast<int>(std::floor(p.y / plan.resolution_m));
    const bool stands = walkways.canStand(p);
    standing += stands;
    if (stands) {
      ASSERT_FALSE(world::discCollides(plan, p, kRadius_m)) << p.x << " " << p.y;
      ASSERT_EQ(plan.at(column, row), world::Cell::kFree);
    } else if (plan.contains(column, row) && plan.at(column, row) == world::Cell::kFree) {
      // Half a diagonal round the centre is given away, and at the plan's edge up to two cells.
      const core::Point2 centre = world::cellsToPoint(plan, {column + 0.5, row + 0.5});
      const int margin = static_cast<int>(kRadius_m / plan.resolution_m) + 2;
      const bool is_at_edge =
          column < margin || row < margin || column >= plan.columns - margin || row >= plan.rows - margin;
      ASSERT_TRUE(is_at_edge || world::discCollides(plan, centre, kRadius_m + half_diagonal_m + 1e-9));
    }
  }
  EXPECT_GT(standing, 1000);
}

TEST(Walkways, LeadFromPlaceToPlaceWithoutLeavingThem) {
  Walkways walkways(sim::twoRooms(), kRadius_m, 3, {3, 3});
  ASSERT_GE(walkways.places(), 2U);
  bool some_goes_through_the_door = false;
  for (size_t place = 0; place < walkways.places(); ++place)
    for (const auto& way : walkways.waysFrom(place)) {
      ASSERT_GE(way.corners.size(), 2U);
      ASSERT_LT(way.to, walkways.places());
      for (size_t i = 1; i < way.corners.size(); ++i)
        EXPECT_TRUE(walkways.isClear(way.corners[i - 1], way.corners[i]));
      some_goes_through_the_door |= (way.corners.front().x < 6) != (way.corners.back().x < 6);
    }
  EXPECT_TRUE(some_goes_through_the_door);
}

TEST(Walkways, StayOnTheSideThatPeopleCanReach) {
  world::Plan plan = sim::twoRooms();
  shut(plan, world::Cell::kOccupied);  // a wall now, not a door
  plan.doors.clear();
  Walkways walkways(plan, kRadius_m, 3, {9, 3});
  ASSERT_GE(walkways.places(), 2U);
  for (size_t place = 0; place < walkways.places(); ++place)
    for (const auto& way : walkways.waysFrom(place)) EXPECT_GT(way.corners.back().x, 6.1);
}

TEST(Walkways, AfterADoorHasMovedAreThoseOfTheNewPlan) {
  world::Plan plan = sim::twoRooms();
  Walkways walkways(plan, kRadius_m, 1, {3, 3});
  const auto& door = plan.doors.front();
  for (const auto cell : {world::Cell::kOccupied, world::Cell::kFree}) {
    shut(plan, cell);
    walkways.update(plan, door.x0, door.y0, door.x1, door.y1);
    const Walkways fresh(plan, kRadius_m, 1, {3, 3});
    for (int row = 0; row < plan.rows; ++row)
      for (int column = 0; column < plan.columns; ++column) {
        const core::Point2 p = world::cellsToPoint(plan, {column + 0.5, row + 0.5});
        ASSERT_EQ(walkways.canStand(p), fresh.canStand(p)) << column << " " << row;
      }
    // The way through is still known; only walking it has become impossible.
    EXPECT_TRUE(walkways.isClear({5, 3}, {7, 3}));
    const double free_m = walkways.freeDistance({5, 3}, {1, 0}, 2);
    if (cell == world::Cell::kFree)
      EXPECT_EQ(free_m, 2);
    else  // the door's cells begin at x = 6 m; a cell and a half is what the mask gives away
      EXPECT_NEAR(free_m, 1 - kRadius_m, 0.08);
  }
}

TEST(Walkways, HaveNoPlaceWhereNobodyFits) {
  world::Plan plan = sim::twoRooms();
  Walkways narrow(plan, 3.5, 1, {3, 3});
  EXPECT_EQ(narrow.places(), 0U);
  EXPECT_FALSE(narrow.canStand({3, 3}));
  EXPECT_FALSE(narrow.canStand({std::nan(""), 3}));
}

TEST(Walkways, AOnlyPlaceHasTheWayToItself) {
  world::Plan plan = sim::twoRooms();
  for (int row = 0; row < plan.rows; ++row)
    for (int column = 0; column < plan.columns; ++column)
      if (std::hypot(column - 60, row - 60) > 9)
        plan.cells[static_cast<size_t>(row) * plan.columns + column] = world::Cell::kOccupied;
  plan.doors.clear();
  Walkways walkways(plan, kRadius_m, 1, {3, 3});
  ASSERT_EQ(walkways.places(), 1U);
  const auto& ways = walkways.waysFrom(0);
  ASSERT_EQ(ways.size(), 1U);
  EXPECT_EQ(ways[0].to, 0U);
  EXPECT_EQ(ways[0].corners.size(), 2U);
}

}  // namespace
}  // namespace slam::movers
