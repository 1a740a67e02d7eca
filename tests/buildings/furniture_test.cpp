#include "libslam/buildings/furniture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "libslam/core/random.h"
#include "tests/world/drawn_plan.h"

namespace slam::buildings {
namespace {

void fill(world::Plan& plan, int x0, int y0, int x1, int y1, world::Cell cell = world::Cell::kOccupied) {
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) plan.cells[static_cast<size_t>(y) * plan.columns + x] = cell;
}

/// 8 x 6 m at 5 cm with walls, a shelf against one, and `pieces` tables of 0.8 x 0.4 m in rows.
world::Plan furnished(int pieces) {
  world::Plan plan;
  plan.name = "furnished";
  plan.columns = 160;
  plan.rows = 120;
  plan.cells.assign(size_t{160} * 120, world::Cell::kFree);
  fill(plan, 0, 0, 160, 2), fill(plan, 0, 118, 160, 120), fill(plan, 0, 0, 2, 120),
      fill(plan, 158, 0, 160, 120);
  fill(plan, 2, 100, 10, 118);
  for (int i = 0; i < pieces; ++i) {
    const int x = 20 + i % 5 * 26, y = 20 + i / 5 * 26;
    fill(plan, x, y, x + 16, y + 8);
  }
  return plan;
}

std::vector<char> waysOf(const world::Plan& plan, double radius_m) {
  std::vector<char> ways(plan.cells.size());
  for (size_t i = 0; i < ways.size(); ++i) {
    const auto column = static_cast<int>(i) % plan.columns, row = static_cast<int>(i) / plan.columns;
    ways[i] = radius_m > 0
                  ? !world::discCollides(plan, world::cellsToPoint(plan, {column + 0.5, row + 0.5}), radius_m)
                  : plan.cells[i] != world::Cell::kOccupied;
  }
  return ways;
}

/// The number of the 4-connected part of every cell that is a way, 0 for the others; by spreading the least
/// number.
std::vector<int> partsOf(const std::vector<char>& ways, int columns) {
  std::vector<int> parts(ways.size(), 0);
  for (size_t i = 0; i < ways.size(); ++i) parts[i] = ways[i] ? static_cast<int>(i) + 1 : 0;
  const auto spread = [&](size_t from, size_t to) {
    if (parts[from] == 0 || parts[to] == 0 || parts[from] >= parts[to]) return false;
    parts[to] = parts[from];
    return true;
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (size_t i = 1; i < parts.size(); ++i) {
      changed |= spread(i - 1, i);
      if (i >= static_cast<size_t>(columns)) changed |= spread(i - static_cast<size_t>(columns), i);
    }
    for (size_t i = parts.size() - 1; i > 0; --i) {
      changed |= spread(i, i - 1);
      if (i >= static_cast<size_t>(columns)) changed |= spread(i, i - static_cast<size_t>(columns));
    }
  }
  return parts;
}

TEST(Furniture, ThatNobodyMovesStays) {
  const world::Plan plan = furnished(10);
  const auto none = moveFurniture(plan, 1, 0);
  EXPECT_EQ(none.plan.cells, plan.cells);
  EXPECT_EQ(none.pieces, 10);  // not the shelf, which stands against a wall, and not the walls
  EXPECT_EQ(none.moved, 0);
  EXPECT_EQ(moveFurniture(furnished(0), 1, 1).plan.cells, furnished(0).cells);
}

TEST(Furniture, MovesTheSameWayForTheSameSeed) {
  const world::Plan plan = furnished(10);
  const auto once = moveFurniture(plan, 1, 1), again = moveFurniture(plan, 1, 1);
  EXPECT_EQ(once.plan.cells, again.plan.cells);
  EXPECT_EQ(once.moved, 10);
  EXPECT_NE(once.plan.cells, plan.cells);
  EXPECT_NE(once.plan.cells, moveFurniture(plan, 2, 1).plan.cells);
}

TEST(Furniture, MovesTheShareThatIsAsked) {
  int moved = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) moved += moveFurniture(furnished(10), seed, 0.3).moved;
  // 400 draws of 0.3: a deviation of 9.2; four of them.
  EXPECT_NEAR(moved, 120, 37);
}

TEST(Furniture, KeepsItsShapeAndItsMaterial) {
  world::Plan plan = furnished(0);
  // An L, one arm of glass.
  fill(plan, 60, 50, 70, 54), fill(plan, 60, 54, 64, 60);
  plan.materials.assign(plan.cells.size(), world::Material::kPlain);
  for (int x = 60; x < 70; ++x) plan.materials[size_t{50} * 160 + x] = world::Material::kGlass;
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    const auto moved = moveFurniture(plan, seed, 1);
    ASSERT_EQ(moved.moved, 1);
    std::vector<int> columns, rows, glass_columns, glass_rows;
    for (int y = 3; y < 99; ++y)
      for (int x = 12; x < 157; ++x) {
        const bool is_glass =
            moved.plan.materials[static_cast<size_t>(y) * 160 + x] == world::Material::kGlass;
        ASSERT_TRUE(!is_glass || moved.plan.at(x, y) == world::Cell::kOccupied);
        if (moved.plan.at(x, y) == world::Cell::kOccupied) columns.push_back(x), rows.push_back(y);
        if (is_glass) glass_columns.push_back(x), glass_rows.push_back(y);
      }
    ASSERT_EQ(columns.size(), 10U * 4 + 4 * 6);
    const auto extent = [](const std::vector<int>& v) {
      const auto [low, high] = std::minmax_element(v.begin(), v.end());
      return *high - *low + 1;
    };
    EXPECT_EQ(extent(columns), 10);
    EXPECT_EQ(extent(rows), 10);
    ASSERT_EQ(glass_columns.size(), 10U);
    EXPECT_EQ(extent(glass_columns) * extent(glass_rows), 10);  // still one straight row
  }
}

TEST(Furniture, ShutsNobodyIn) {
  core::RandomStream random(1, "rooms");
  int moved = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    // Two rooms and a corridor, and tables strewn about.
    world::Plan plan = furnished(0);
    fill(plan, 78, 0, 80, 50), fill(plan, 78, 68, 80, 118);
    for (int i = 0; i < 14; ++i) {
      const int x = 14 + static_cast<int>(random.below(110)), y = 6 + static_cast<int>(random.below(85));
      fill(plan, x, y, x + 4 + static_cast<int>(random.below(14)),
           y + 4 + static_cast<int>(random.below(14)));
    }
    const auto after = moveFurniture(plan, seed, 1);
    moved += after.moved;
    for (const double radius_m : {0.0, 0.3}) {
      // Whatever was one part before, and can still be stood on, is one part now.
      const auto before = partsOf(waysOf(plan, radius_m), plan.columns),
                 now = partsOf(waysOf(after.plan, radius_m), plan.columns);
      std::map<int, int> became;
      for (size_t cell = 0; cell < before.size(); ++cell) {
        if (before[cell] == 0 || now[cell] == 0) continue;
        ASSERT_EQ(became.try_emplace(before[cell], now[cell]).first->second, now[cell])
            << "seed " << seed << ", radius " << radius_m << ", cell " << cell % 160 << " " << cell / 160;
      }
    }
  }
  EXPECT_GT(moved, 60);
}

TEST(Furniture, LeavesDoorwaysClear) {
  world::Plan plan = furnished(0);
  fill(plan, 78, 0, 80, 50), fill(plan, 78, 70, 80, 118);
  fill(plan, 62, 56, 68, 62);
  plan.doors = {{78, 50, 80, 70}};
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const auto after = moveFurniture(plan, seed, 1);
    for (int y = 50; y < 70; ++y)
      for (int x = 78 - 6; x < 80 + 6; ++x)
        ASSERT_EQ(after.plan.at(x, y), world::Cell::kFree) << "seed " << seed;
  }
}

TEST(Furniture, IsNotCarriedThroughAWall) {
  world::Plan plan = furnished(0);
  fill(plan, 78, 0, 80, 120);
  fill(plan, 72, 56, 76, 62);
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const auto after = moveFurniture(plan, seed, 1);
    EXPECT_EQ(after.moved, 1);
    for (int y = 2; y < 118; ++y)
      for (int x = 80; x < 158; ++x) ASSERT_EQ(after.plan.at(x, y), world::Cell::kFree) << "seed " << seed;
  }
}

TEST(Furniture, TakesATablesLegsTogether) {
  world::Plan plan = furnished(0);
  for (const int x : {60, 82})
    for (const int y : {50, 64}) fill(plan, x, y, x + 2, y + 2);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto after = moveFurniture(plan, seed, 1);
    EXPECT_EQ(after.pieces, 1);
    std::vector<int> columns, rows;
    for (int y = 2; y < 100; ++y)
      for (int x = 12; x < 158; ++x)
        if (after.plan.at(x, y) == world::Cell::kOccupied) columns.push_back(x), rows.push_back(y);
    ASSERT_EQ(columns.size(), 16U);
    const auto [left, right] = std::minmax_element(columns.begin(), columns.end());
    const auto [low, high] = std::minmax_element(rows.begin(), rows.end());
    EXPECT_EQ(std::max(*right - *left, *high - *low), 23);
    EXPECT_EQ(std::min(*right - *left, *high - *low), 15);
  }
}

TEST(Furniture, IsNeitherAWallBetweenDoorwaysNorLargerThanSaid) {
  world::Plan plan = furnished(0);
  fill(plan, 60, 50, 63, 80);  // 1.5 m long, 15 cm thick
  EXPECT_EQ(moveFurniture(plan, 1, 1).pieces, 0);
  fill(plan, 60, 50, 80, 102);  // 2.6 m
  EXPECT_EQ(moveFurniture(plan, 1, 1).pieces, 0);
  FurnitureRules rules;
  rules.largest_m = 3;
  EXPECT_EQ(moveFurniture(plan, 1, 1, rules).pieces, 1);
}

TEST(Furniture, StaysWhereThereIsNoOtherPlace) {
  const world::Plan plan = world::drawnPlan({"#####", "#...#", "#.#.#", "#...#", "#####"}, 0.05);
  const auto after = moveFurniture(plan, 1, 1);
  EXPECT_EQ(after.pieces, 1);
  EXPECT_EQ(after.plan.cells.size(), plan.cells.size());
  EXPECT_EQ(std::count(after.plan.cells.begin(), after.plan.cells.end(), world::Cell::kOccupied),
            std::count(plan.cells.begin(), plan.cells.end(), world::Cell::kOccupied));
}

}  // namespace
}  // namespace slam::buildings
