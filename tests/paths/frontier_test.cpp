#include "libslam/paths/frontier.h"

#include <gtest/gtest.h>

#include "tests/paths/drawn_map.h"
#include "tests/paths/kept_map.h"

namespace slam::paths {
namespace {

/// The map with the cells of frontier k drawn as the letter k.
std::string drawn(const gridmap::OccupancyRaster& map, size_t min_cells) {
  const auto space = readFreeSpace(map);
  const auto frontiers = findFrontiers(space, min_cells);
  std::string text;
  for (int row = space.rows - 2; row > 0; --row) {
    for (int column = 1; column + 1 < space.columns; ++column) {
      char c = ".#?"[space.state[space.index(column, row)]];
      for (size_t k = 0; k < frontiers.size(); ++k)
        for (const size_t cell : frontiers[k].cells)
          if (cell == space.index(column, row)) c = static_cast<char>('A' + k);
      text += c;
    }
    text += '\n';
  }
  return text;
}

const std::vector<std::string> kRoom = {"#########",  //
                                        "#...??..#",  //
                                        "#...??..#",  //
                                        "#......##",  //
                                        "##.######",  //
                                        "??.??????"};

TEST(Frontiers, AreTheFreeCellsBesideTheUnknownInTouchingGroups) {
  EXPECT_EQ(drawn(drawnMap(kRoom), 1),
            "#########\n"
            "#..B??B.#\n"
            "#..B??B.#\n"
            "#...BB.##\n"
            "##.######\n"
            "??A??????\n");
}

TEST(Frontiers, ShorterThanAskedForDoNotCount) {
  EXPECT_EQ(drawn(drawnMap(kRoom), 2),
            "#########\n"
            "#..A??A.#\n"
            "#..A??A.#\n"
            "#...AA.##\n"
            "##.######\n"
            "??.??????\n");
  EXPECT_TRUE(findFrontiers(readFreeSpace(drawnMap(kRoom)), 7).empty());
}

TEST(Frontiers, GoOnAtTheRastersEdgeAndNotThroughWalls) {
  EXPECT_EQ(drawn(drawnMap({"...", ".#.", "..."}), 1), "AAA\nA#A\nAAA\n");
  EXPECT_EQ(drawn(drawnMap({"####", "#..#", "####", "????"}), 1), "####\n#..#\n####\n????\n");
  EXPECT_TRUE(findFrontiers(readFreeSpace(drawnMap({"???"})), 1).empty());
  EXPECT_TRUE(findFrontiers(readFreeSpace(gridmap::OccupancyRaster()), 1).empty());
}

TEST(FrontierCells, KeptAreThoseOfTheWholeMapWhateverChanges) {
  core::RandomStream random(4, "frontier cells");
  auto map = unknownRaster(60, 50);
  FreeSpace space;
  FrontierCells kept;
  strew(map, {0, 0}, {60, 50}, 1500, random);
  // All of it, the middle, the lowest and the highest rows, one cell, nothing, a larger map.
  for (const auto& [first, last] :
       {std::pair(std::pair(0, 0), std::pair(60, 50)), std::pair(std::pair(20, 20), std::pair(30, 31)),
        std::pair(std::pair(0, 0), std::pair(60, 1)), std::pair(std::pair(3, 49), std::pair(60, 50)),
        std::pair(std::pair(7, 8), std::pair(8, 9)), std::pair(std::pair(7, 8), std::pair(7, 8))}) {
    strew(map, first, last, 40, random);
    kept.update(space, updateFreeSpace(map, space));
    EXPECT_EQ(kept.cells(), frontierCells(space));
    EXPECT_FALSE(kept.cells().empty());
  }
  auto larger = unknownRaster(60, 70);
  strew(larger, {0, 0}, {60, 70}, 1500, random);
  kept.update(space, updateFreeSpace(larger, space));
  EXPECT_EQ(kept.cells(), frontierCells(space));
}

TEST(FrontierCells, OfTheRowsBesideWhatHasChangedAreFoundAnew) {
  const auto before = readFreeSpace(drawnMap({"......", "......", "......", "......", "......"}));
  const auto after = readFreeSpace(drawnMap({"......", "......", "..?...", "......", "......"}));
  FrontierCells kept;
  kept.update(before, {0, 0, before.columns, before.rows});
  int cell = 0;
  while (before.state[static_cast<size_t>(cell)] == after.state[static_cast<size_t>(cell)]) ++cell;
  const int column = cell % after.columns, row = cell / after.columns;
  kept.update(after, {column, row, column + 1, row + 1});
  EXPECT_EQ(kept.cells(), frontierCells(after));
  EXPECT_NE(frontierCells(after), frontierCells(before));
}

}  // namespace
}  // namespace slam::paths
