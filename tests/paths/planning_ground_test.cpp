#include "libslam/paths/planning_ground.h"

#include <gtest/gtest.h>

#include "libslam/core/random.h"
#include "libslam/paths/path_planner.h"

namespace slam::paths {
namespace {

FreeSpace allFree(int columns, int rows) {
  FreeSpace space;
  space.columns = columns, space.rows = rows;
  space.resolution_m = 0.05;
  space.state.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), kFreeCell);
  return space;
}

/// Small blocks of all states.
void strew(FreeSpace& space, const CellBlock& where, int blocks, core::RandomStream& random) {
  for (int i = 0; i < blocks; ++i) {
    const int column = where.first_column + static_cast<int>(random.uniform(0, where.columns()));
    const int row = where.first_row + static_cast<int>(random.uniform(0, where.last_row - where.first_row));
    const auto state = static_cast<std::uint8_t>(random.uniform(0, 3));
    for (int r = row; r < std::min(row + 4, where.last_row); ++r)
      for (int c = column; c < std::min(column + 4, where.last_column); ++c)
        space.state[space.index(c, r)] = state;
  }
}

void expectEqualToAFreshOne(const PlanningGround& ground, const FreeSpace& map,
                            const PlannerOptions& options) {
  FreeSpace closed = map;
  closeGaps(closed);
  EXPECT_EQ(ground.space().state, closed.state);
  EXPECT_EQ(ground.space().x_min_m, map.x_min_m);
  const PlanningNodes fresh(closed, options);
  EXPECT_EQ(ground.nodes()->clearance, fresh.clearance);
  EXPECT_EQ(ground.nodes()->factor, fresh.factor);
  EXPECT_EQ(ground.nodes()->best_cell, fresh.best_cell);
  EXPECT_EQ(ground.nodes()->is_free, fresh.is_free);
}

TEST(PlanningGround, IsTheSameAsAFreshOneWhateverChanges) {
  core::RandomStream random(1, "ground");
  for (const double node_m : {0.05, 0.1, 0.15}) {
    PlannerOptions options;
    options.radius_m = 0.2, options.comfort_m = 0.4, options.node_m = node_m;
    auto map = allFree(150, 131);
    strew(map, {0, 0, 150, 131}, 80, random);
    PlanningGround ground;
    ground.update(map, options);
    expectEqualToAFreshOne(ground, map, options);
    // In the middle, in every corner, a single cell, nothing, and nearly all of it.
    for (const CellBlock& block :
         {CellBlock{60, 60, 90, 80}, CellBlock{0, 0, 20, 20}, CellBlock{130, 111, 150, 131},
          CellBlock{0, 120, 10, 131}, CellBlock{75, 3, 76, 4}, CellBlock{75, 3, 76, 4},
          CellBlock{1, 1, 149, 130}}) {
      strew(map, block, 12, random);
      ground.update(map, options);
      expectEqualToAFreshOne(ground, map, options);
    }
  }
}

TEST(PlanningGround, IsMadeAnewForAnotherSizeOrOtherOptions) {
  core::RandomStream random(2, "ground");
  PlannerOptions options;
  options.radius_m = 0.2, options.comfort_m = 0.4;
  PlanningGround ground;
  for (const int columns : {100, 120, 90}) {
    auto map = allFree(columns, 80);
    map.x_min_m = columns;
    strew(map, {0, 0, columns, 80}, 60, random);
    ground.update(map, options);
    expectEqualToAFreshOne(ground, map, options);
    options.radius_m += 0.05;
    ground.update(map, options);
    expectEqualToAFreshOne(ground, map, options);
    options.optimistic = !options.optimistic;
    ground.update(map, options);
    expectEqualToAFreshOne(ground, map, options);
    // The same cells in another place.
    map.x_min_m += 3;
    ground.update(map, options);
    expectEqualToAFreshOne(ground, map, options);
  }
}

TEST(PlanningGround, LeavesANodesHolderWhatItHad) {
  auto map = allFree(100, 100);
  const PlannerOptions options;
  PlanningGround ground;
  ground.update(map, options);
  const auto held = ground.nodes();
  // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): what is held must not change
  const auto before = *held;
  map.state[map.index(50, 50)] = kOccupiedCell;
  ground.update(map, options);
  EXPECT_EQ(held->clearance, before.clearance);
  EXPECT_NE(ground.nodes()->clearance, before.clearance);
}

TEST(PlanningGround, PlansAsTheWholeMapDoes) {
  core::RandomStream random(4, "ground");
  PlannerOptions options;
  options.radius_m = 0.2, options.comfort_m = 0.4;
  auto map = allFree(160, 120);
  PlanningGround ground;
  for (int i = 0; i < 10; ++i) {
    strew(map, {10 + 10 * i, 20, 40 + 10 * i, 100}, 20, random);
    ground.update(map, options);
    FreeSpace closed = map;
    closeGaps(closed);
    const core::Point2 robot{1.0, 0.5};
    const PathPlanner a(ground, options, robot), b(closed, options, robot);
    ASSERT_EQ(a.reachedCount(), b.reachedCount());
    for (PathPlanner::Node node = 0; node < a.nodeColumns() * a.nodeRows(); ++node) {
      ASSERT_EQ(a.isReached(node), b.isReached(node));
      if (a.isReached(node)) {
        ASSERT_EQ(a.cost(node), b.cost(node));
      }
      ASSERT_EQ(a.accessOf(node), b.accessOf(node));
    }
  }
}

TEST(ChangedCells, AreTheLeastBlockThatHoldsThemAll) {
  const auto before = allFree(40, 30);
  auto after = before;
  EXPECT_TRUE(changedCells(before, after).isEmpty());
  after.state[after.index(7, 20)] = kOccupiedCell;
  after.state[after.index(31, 4)] = kUnknownCell;
  const auto block = changedCells(before, after);
  EXPECT_EQ(block.first_column, 7);
  EXPECT_EQ(block.last_column, 32);
  EXPECT_EQ(block.first_row, 4);
  EXPECT_EQ(block.last_row, 21);
  auto last = before;
  last.state.back() = last.state.front() = kOccupiedCell;
  EXPECT_EQ(changedCells(before, last).cells(), 1200U);
}

}  // namespace
}  // namespace slam::paths
