#include "libslam/paths/free_space.h"

#include <gtest/gtest.h>

#include <limits>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "tests/paths/drawn_map.h"

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
