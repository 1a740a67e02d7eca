#include "libslam/buildings/building.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/world/plan.h"

namespace slam::buildings {
namespace {

/// The accepted cells that are 4-connected with one of `open` through accepted cells.
template <class Accept>
std::vector<char> floodFrom(const world::Plan& plan, std::vector<size_t> open, Accept accept) {
  std::vector<char> reached(plan.cells.size(), 0);
  const auto columns = static_cast<size_t>(plan.columns);
  const auto enter = [&](size_t index) {
    if (reached[index] || !accept(index)) return;
    reached[index] = 1;
    open.push_back(index);
  };
  const std::vector<size_t> seeds = std::move(open);
  open.clear();
  for (const size_t seed : seeds) enter(seed);
  while (!open.empty()) {
    const size_t index = open.back();
    open.pop_back();
    if (index % columns > 0) enter(index - 1);
    if (index % columns + 1 < columns) enter(index + 1);
    if (index >= columns) enter(index - columns);
    if (index + columns < reached.size()) enter(index + columns);
  }
  return reached;
}

/// The accepted cells that cannot be reached from the first of them.
template <class Accept>
std::ptrdiff_t unreachable(const world::Plan& plan, Accept accept) {
  size_t first = 0, accepted = 0;
  for (size_t i = plan.cells.size(); i-- > 0;)
    if (accept(i)) first = i, ++accepted;
  const auto reached = floodFrom(plan, {first}, accept);
  return static_cast<std::ptrdiff_t>(accepted) - std::count(reached.begin(), reached.end(), 1);
}

std::vector<size_t> rim(const world::Plan& plan) {
  std::vector<size_t> cells;
  for (int row = 0; row < plan.rows; ++row)
    for (int column = 0; column < plan.columns; ++column)
      if (row == 0 || column == 0 || row + 1 == plan.rows || column + 1 == plan.columns)
        cells.push_back(static_cast<size_t>(row) * plan.columns + column);
  return cells;
}

constexpr std::uint64_t kSeeds = 2;  // forty were tried when the generators were written

/// Every world is drawn once for all the tests below.
const world::Plan& drawn(const std::string& name, std::uint64_t seed) {
  static std::map<std::pair<std::string, std::uint64_t>, world::Plan> plans;
  const auto it = plans.find({name, seed});
  return it != plans.end() ? it->second : plans[{name, seed}] = makeBuilding(name, seed);
}

class Buildings : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, Buildings, ::testing::ValuesIn(buildingNames()),
                         [](const auto& building) { return building.param; });

TEST_P(Buildings, AreDrawnAsCommitted) {
  const world::Plan& plan = drawn(GetParam(), 1);
  const world::Plan again = makeBuilding(GetParam(), 1);
  const world::Plan committed =
      world::loadPlan(std::string(RASTERSLAM_SOURCE_DIR) + "/datasets/worlds/" + GetParam() + ".yaml");
  EXPECT_EQ(plan.name, GetParam());
  EXPECT_EQ(committed.name, GetParam());
  EXPECT_TRUE(plan.cells == again.cells);
  ASSERT_EQ(plan.columns, committed.columns);
  ASSERT_EQ(plan.rows, committed.rows);
  EXPECT_EQ(plan.resolution_m, 0.05);
  EXPECT_EQ(committed.resolution_m, 0.05);
  EXPECT_TRUE(plan.cells == committed.cells) << "run make_worlds datasets/worlds";
}

TEST_P(Buildings, DifferFromSeedToSeed) {
  EXPECT_FALSE(drawn(GetParam(), 1).cells == drawn(GetParam(), 2).cells);
}

TEST_P(Buildings, AreEnclosedByWalls) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const world::Plan& plan = drawn(GetParam(), seed);
    const auto outside =
        floodFrom(plan, rim(plan), [&](size_t i) { return plan.cells[i] != world::Cell::kOccupied; });
    for (size_t i = 0; i < plan.cells.size(); ++i)
      ASSERT_FALSE(outside[i] && plan.cells[i] != world::Cell::kUnknown) << "seed " << seed << ", cell " << i;
  }
}

TEST_P(Buildings, HaveNothingThinnerThanTwoCells) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const world::Plan& plan = drawn(GetParam(), seed);
    const auto isWall = [&](int column, int row) { return plan.at(column, row) == world::Cell::kOccupied; };
    std::vector<char> in_block(plan.cells.size(), 0);
    for (int row = 0; row + 1 < plan.rows; ++row)
      for (int column = 0; column + 1 < plan.columns; ++column)
        if (isWall(column, row) && isWall(column + 1, row) && isWall(column, row + 1) &&
            isWall(column + 1, row + 1))
          for (const int dr : {0, 1})
            for (const int dc : {0, 1})
              in_block[static_cast<size_t>(row + dr) * plan.columns + column + dc] = 1;
    for (size_t i = 0; i < plan.cells.size(); ++i)
      ASSERT_EQ(in_block[i] == 1, plan.cells[i] == world::Cell::kOccupied)
          << "seed " << seed << ", cell " << i;
  }
}

TEST_P(Buildings, LetTheRobotReachEveryPlace) {
  constexpr double kRobotRadius_m = 0.2;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const world::Plan& plan = drawn(GetParam(), seed);
    EXPECT_EQ(unreachable(plan, [&](size_t i) { return plan.cells[i] == world::Cell::kFree; }), 0)
        << "seed " << seed;
    std::vector<char> admissible(plan.cells.size());
    for (size_t i = 0; i < plan.cells.size(); ++i) {
      if (plan.cells[i] != world::Cell::kFree) continue;
      const int column = static_cast<int>(i % plan.columns), row = static_cast<int>(i / plan.columns);
      const core::Point2 centre{column + 0.5, row + 0.5};
      admissible[i] = !world::discCollides(plan, world::cellsToPoint(plan, centre), kRobotRadius_m);
    }
    EXPECT_EQ(unreachable(plan, [&](size_t i) { return admissible[i] != 0; }), 0) << "seed " << seed;
    EXPECT_TRUE(world::findStartPose(plan, 0.35)) << "seed " << seed;
  }
}

TEST(BuildingNames, GiveTheNearestForAnUnknownOne) {
  try {
    makeBuilding("ofice_loop", 1);
    FAIL();
  } catch (const core::InputError& e) {
    EXPECT_STREQ(
        e.what(),
        "unknown world 'ofice_loop', expected one of flat, office_loop, pillar_hall, corridor, maze; did you "
        "mean 'office_loop'?");
  }
}

TEST(BuildingSizes, AreAsDescribed) {
  const auto sizeOf = [](const std::string& name) {
    const world::Plan& plan = drawn(name, 1);
    int least_column = plan.columns, most_column = 0, least_row = plan.rows, most_row = 0;
    for (int row = 0; row < plan.rows; ++row)
      for (int column = 0; column < plan.columns; ++column)
        if (plan.at(column, row) == world::Cell::kFree) {
          least_column = std::min(least_column, column), most_column = std::max(most_column, column);
          least_row = std::min(least_row, row), most_row = std::max(most_row, row);
        }
    return std::pair<double, double>(0.05 * (most_column - least_column + 1),
                                     0.05 * (most_row - least_row + 1));
  };
  const double tolerance_m = 0.35;  // niches on both sides
  const auto expectSize = [&](const std::string& name, double width_m, double height_m) {
    const auto [width, height] = sizeOf(name);
    EXPECT_NEAR(width, width_m, tolerance_m) << name;
    EXPECT_NEAR(height, height_m, tolerance_m) << name;
  };
  expectSize("flat", 12, 9);
  expectSize("office_loop", 40, 25);
  expectSize("pillar_hall", 25, 20);
  expectSize("corridor", 60, 5.8);
  expectSize("maze", 15.8, 15.8);
}

}  // namespace
}  // namespace slam::buildings
