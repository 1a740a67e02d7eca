#include "libslam/paths/close_walls.h"

#include <gtest/gtest.h>

#include "tests/paths/drawn_map.h"

namespace slam::paths {
namespace {

std::string closed(const std::vector<std::string>& lines, double gap_m) {
  auto space = readFreeSpace(drawnMap(lines, 0.1));
  closeWalls(space, gap_m);
  std::string text;
  for (int row = space.rows - 2; row > 0; --row) {
    for (int column = 1; column + 1 < space.columns; ++column)
      text += ".#?"[space.state[space.index(column, row)]];
    text += '\n';
  }
  return text;
}

TEST(CloseWalls, FillsTheGapsOfAWallAndLeavesADoor) {
  const std::vector<std::string> wall = {"???????????????",  //
                                         "#?#??#??????###",  //
                                         "...............",  //
                                         "..............."};
  EXPECT_EQ(closed(wall, 0.35),
            "???????????????\n"
            "######??????###\n"
            "...............\n"
            "...............\n");
  EXPECT_EQ(closed(wall, 0.2),
            "???????????????\n"
            "###??#??????###\n"
            "...............\n"
            "...............\n");
  EXPECT_EQ(closed(wall, 0), "???????????????\n#?#??#??????###\n...............\n...............\n");
}

TEST(CloseWalls, FollowsASlantedWallAndClosesNothingAcrossFreeFloor) {
  EXPECT_EQ(closed({"#??????",  //
                    ".??????",  //
                    "..#????",  //
                    "...????",  //
                    "....#??"},
                   0.45),
            "#??????\n"
            ".#?????\n"
            "..#????\n"
            "...#???\n"
            "....#??\n");
  // The unknown between two occupied cells, but with floor before one of them: a look behind shows something.
  EXPECT_EQ(closed({"???????", "#.??#??", "......."}, 0.5), "???????\n#.??#??\n.......\n");
}

}  // namespace
}  // namespace slam::paths
