#include "libslam/paths/frontier.h"

#include <gtest/gtest.h>

#include "tests/paths/drawn_map.h"

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

}  // namespace
}  // namespace slam::paths
