#include "libslam/oracle/cell_sight.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "libslam/core/random.h"
#include "libslam/rays/ray_walk.h"
#include "tests/world/drawn_plan.h"

namespace slam::oracle {
namespace {

std::set<std::size_t> seeing(const world::Plan& plan, const Block& block, double range_cells = 0) {
  std::set<std::size_t> cells;
  visitSeeing(plan, block, range_cells, [&](std::size_t cell) {
    cells.insert(cell);
    return true;
  });
  return cells;
}

bool isIn(const Block& block, int column, int row) {
  return column >= block.column && column < block.column + block.side && row >= block.row &&
         row < block.row + block.side;
}

/// Whether the straight line keeps to cells that are free or of the block, by the walk that rays take.
bool isClear(const world::Plan& plan, const Block& block, const core::Point2& a, const core::Point2& b) {
  const double length = core::distance(a, b);
  const auto end =
      static_cast<std::size_t>(b.y) * static_cast<std::size_t>(plan.columns) + static_cast<std::size_t>(b.x);
  bool arrives = false;
  rays::walkRay(plan, a, {(b.x - a.x) / length, (b.y - a.y) / length}, length + 1,
                [&](const world::Cell* cell, const rays::RayEntry&) {
                  const auto index = static_cast<std::size_t>(cell - plan.cells.data());
                  arrives = arrives || index == end;
                  const int column = static_cast<int>(index) % plan.columns,
                            row = static_cast<int>(index) / plan.columns;
                  return !arrives && (*cell != world::Cell::kOccupied || isIn(block, column, row));
                });
  return arrives;
}

TEST(VisitSeeing, LooksThroughAGapAndNotThroughAWall) {
  const auto plan = world::drawnPlan({"#######",  //
                                      "#..#..#",  //
                                      "#..#..#",  //
                                      "#.....#",  //
                                      "#..#..#",  //
                                      "#..##.#",  //
                                      "#######"});
  const auto cells = seeing(plan, {1, 3, 1});
  EXPECT_TRUE(cells.count(3 * 7 + 5));   // straight through
  EXPECT_TRUE(cells.count(4 * 7 + 5));   // and a little aside
  EXPECT_FALSE(cells.count(1 * 7 + 5));  // behind the corner
  EXPECT_FALSE(cells.count(5 * 7 + 4));  // too steep for any line through the gap
}

TEST(VisitSeeing, EndsAtTheRangeAndWhenItIsToldTo) {
  const auto plan = world::drawnPlan({"..........", ".........."});
  const auto cells = seeing(plan, {0, 0, 1}, 3);
  EXPECT_TRUE(cells.count(4));  // its near side is three cells from the block's
  EXPECT_FALSE(cells.count(5));
  int visits = 0;
  visitSeeing(plan, {0, 0, 1}, 0, [&](std::size_t) { return ++visits < 3; });
  EXPECT_EQ(visits, 3);
}

// The point of it: whatever any line of sight reaches is there.
TEST(VisitSeeing, LeavesNoLineOfSightOut) {
  core::RandomStream random(3, "cell sight");
  int lines = 0;
  for (int drawn = 0; drawn < 40; ++drawn) {
    auto plan = world::drawnPlan(std::vector<std::string>(12, std::string(14, '.')));
    for (auto& cell : plan.cells)
      if (random.chance(0.3)) cell = world::Cell::kOccupied;
    const Block block{static_cast<int>(random.below(11)), static_cast<int>(random.below(9)),
                      1 + static_cast<int>(random.below(3))};
    const auto cells = seeing(plan, block);
    for (int i = 0; i < 300; ++i) {
      const core::Point2 a{block.column + block.side * random.uniform(),
                           block.row + block.side * random.uniform()};
      const core::Point2 b{14 * random.uniform(), 12 * random.uniform()};
      const auto cell = static_cast<std::size_t>(b.y) * 14 + static_cast<std::size_t>(b.x);
      if (plan.cells[cell] == world::Cell::kOccupied || !isClear(plan, block, a, b)) continue;
      ++lines;
      EXPECT_TRUE(cells.count(cell)) << "drawing " << drawn << ": (" << a.x << ", " << a.y << ") to (" << b.x
                                     << ", " << b.y << ")";
    }
  }
  EXPECT_GT(lines, 1000);
}

}  // namespace
}  // namespace slam::oracle
