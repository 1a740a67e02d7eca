#include "libslam/paths/free_space.h"

#include <gtest/gtest.h>

#include <limits>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "tests/paths/drawn_map.h"
#include "tests/paths/kept_map.h"

namespace slam::paths {
namespace {

std::string states(const FreeSpace& space) {
  std::string text;
  for (int row = space.rows - 1; row >= 0; --row) {
    for (int column = 0; column < space.columns; ++column)
      text += ".#?"[space.state[space.index(column, row)]];
    text += '\n';
  }
  return text;
}

TEST(FreeSpace, HasABorderOfTheUnknown) {
  const auto space = readFreeSpace(drawnMap({"#.", "?."}));
  EXPECT_EQ(states(space),
            "????\n"
            "?#.?\n"
            "??.?\n"
            "????\n");
  EXPECT_EQ(space.known, 3u);
  EXPECT_EQ(space.at({0.5, 1.5}), kOccupiedCell);
  EXPECT_EQ(space.at({1.5, 0.5}), kFreeCell);
  EXPECT_EQ(space.at({-9, 0}), kUnknownCell);
  EXPECT_EQ(space.columnOf(space.centreOf(space.index(2, 1)).x), 2);
}

TEST(FreeSpace, TakesTheMapsThresholdsAndNothingElseForKnown) {
  gridmap::OccupancyRaster map;
  map.columns = 5, map.rows = 1;
  map.occupancy = {0.39F, 0.4F, 0.6F, 0.61F, std::numeric_limits<float>::quiet_NaN()};
  EXPECT_EQ(states(readFreeSpace(map)).substr(8, 7), "?.??#??");
}

TEST(FreeSpace, OfAnEmptyMapIsOnlyTheBorder) {
  EXPECT_EQ(states(readFreeSpace(gridmap::OccupancyRaster())), "??\n??\n");
}

TEST(FreeSpace, RefusesAMapWhoseSizesDoNotFit) {
  auto map = drawnMap({"..", ".."});
  map.rows = 3;
  EXPECT_THROW(readFreeSpace(map), core::ContractError);
  map = drawnMap({".."});
  map.resolution_m = 0;
  EXPECT_THROW(readFreeSpace(map), core::ContractError);
}

TEST(FreeSpace, OfAMapThatChangesIsTheSameAsAFreshOneAndSaysWhatChanged) {
  core::RandomStream random(3, "free space");
  auto map = unknownRaster(40, 30);
  FreeSpace kept;
  const auto whole = updateFreeSpace(map, kept);
  EXPECT_EQ(whole.cells(), kept.state.size());
  strew(map, {0, 0}, {40, 30}, 800, random);
  updateFreeSpace(map, kept);
  for (const auto& [first, last] :
       {std::pair(std::pair(5, 7), std::pair(20, 9)), std::pair(std::pair(0, 0), std::pair(1, 1)),
        std::pair(std::pair(39, 29), std::pair(40, 30))}) {
    map.occupancy[static_cast<std::size_t>(first.second) * 40 + first.first] = 0.1F;
    const FreeSpace before = kept;
    strew(map, first, last, 30, random);
    map.x_min_m += 0.05;
    const auto changed = updateFreeSpace(map, kept);
    const FreeSpace fresh = readFreeSpace(map);
    EXPECT_EQ(kept.state, fresh.state);
    EXPECT_EQ(kept.known, fresh.known);
    EXPECT_EQ(kept.x_min_m, fresh.x_min_m);
    const auto expected = changedCells(before, fresh);
    EXPECT_EQ(changed.first_column, expected.first_column);
    EXPECT_EQ(changed.first_row, expected.first_row);
    EXPECT_EQ(changed.last_column, expected.last_column);
    EXPECT_EQ(changed.last_row, expected.last_row);
  }
  EXPECT_TRUE(updateFreeSpace(map, kept).isEmpty());
  const auto larger = unknownRaster(41, 30);
  EXPECT_EQ(updateFreeSpace(larger, kept).cells(), readFreeSpace(larger).state.size());
  EXPECT_EQ(kept.state, readFreeSpace(larger).state);
}

TEST(CellBlocks, JoinedAreTheLeastBlockAroundBoth) {
  const auto both = joined({3, 4, 5, 9}, {1, 6, 4, 7});
  EXPECT_EQ(both.first_column, 1);
  EXPECT_EQ(both.first_row, 4);
  EXPECT_EQ(both.last_column, 5);
  EXPECT_EQ(both.last_row, 9);
  EXPECT_EQ(joined({}, {3, 4, 5, 9}).first_column, 3);
  EXPECT_EQ(joined({3, 4, 5, 9}, {7, 7, 7, 8}).last_row, 9);
}

TEST(SquaredClearance, EqualsTheSearchOverAllCells) {
  core::RandomStream random(1, "clearance");
  for (const int reach : {1, 2, 5, 9}) {
    gridmap::OccupancyRaster map;
    map.columns = 23, map.rows = 31;
    for (int i = 0; i < map.columns * map.rows; ++i)
      map.occupancy.push_back(random.chance(0.02) ? 0.9F : random.chance(0.02) ? 0.5F : 0.1F);
    const auto space = readFreeSpace(map);
    for (const int obstacles : {kOccupiedCell | kUnknownCell, int{kOccupiedCell}}) {
      const auto clearance = squaredClearance(space, static_cast<std::uint8_t>(obstacles), reach);
      for (int row = 0; row < space.rows; ++row)
        for (int column = 0; column < space.columns; ++column) {
          int nearest = reach * reach;
          for (int r = 0; r < space.rows; ++r)
            for (int c = 0; c < space.columns; ++c)
              if (space.state[space.index(c, r)] & obstacles)
                nearest = std::min(nearest, (r - row) * (r - row) + (c - column) * (c - column));
          ASSERT_EQ(clearance[space.index(column, row)], nearest) << column << ", " << row << ", " << reach;
        }
    }
  }
}

TEST(CloseGaps, FillsWhatLiesBetweenTwoBeamsAndTouchesNoWall) {
  auto space = readFreeSpace(drawnMap(
      {"........#",  //
       "..?...?..",  // between two free cells; beside a wall
       "........#",  //
       ".??...???",  // two cells wide, still between above and below; an edge, of which only the corner goes
       "......???",  //
       "......???"}));
  closeGaps(space);
  EXPECT_EQ(states(space),
            "???????????\n"
            "?........#?\n"
            "?.........?\n"
            "?........#?\n"
            "?.......??\?\n"
            "?......???\?\n"
            "?......???\?\n"
            "???????????\n");
}

}  // namespace
}  // namespace slam::paths
