#include "libslam/paths/coarse_ways.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/paths/drawn_map.h"

namespace slam::paths {
namespace {

/// Two rooms beside each other with a door at the top, 0.4 m a character.
const std::vector<std::string> kTwoRooms = {"###################",  //
                                            "#.................#",  //
                                            "#.................#",  //
                                            "#.................#",  //
                                            "#........#........#",  //
                                            "#........#........#",  //
                                            "#........#........#",  //
                                            "#........#........#",  //
                                            "###################"};

TEST(CoarseWays, GoRoundTheWallAndAreAsLongFromBothEnds) {
  const auto space = readFreeSpace(enlarged(kTwoRooms, 8, 0.05));
  const PathPlanner planner(space, {}, {2, 1});
  const auto nodeAt = [&](double x, double y) {
    return planner.nodeOf(space.index(space.columnOf(x), space.rowOf(y)));
  };
  const auto left = nodeAt(3.0, 0.9), right = nodeAt(4.6, 0.9), top = nodeAt(2.0, 2.6);
  for (const std::size_t most_blocks : {100000U, 500U, 100U}) {
    const CoarseWays ways(planner, most_blocks);
    const auto from_left = ways.lengths(left, {right, top, left});
    // Up to the door at 2 m and the radius, over, and down again; straight ahead would be 1.6 m. Diagonals,
    // blocks of up to 0.6 m at both ends, and the corner that the disc cuts stay within a metre.
    const double least_m = 2 * (2.0 - 0.9);
    EXPECT_GT(from_left[0], least_m) << most_blocks;
    EXPECT_LT(from_left[0], least_m + 2.2) << most_blocks;
    EXPECT_NEAR(from_left[1], std::hypot(1.0, 1.7), 0.7) << most_blocks;
    EXPECT_EQ(from_left[2], 0) << most_blocks;
    EXPECT_DOUBLE_EQ(ways.lengths(right, {left})[0], from_left[0]) << most_blocks;
  }
}

TEST(CoarseWays, OfThePlannersOwnNodesAreItsWaysWhereThereIsRoom) {
  const auto space = readFreeSpace(enlarged({"############", "#..........#", "#..........#", "#..........#",
                                             "#..........#", "#..........#", "############"},
                                            8, 0.05));
  PlannerOptions options;
  options.comfort_m = options.radius_m;  // then cost is length
  const PathPlanner planner(space, options, {1, 1});
  const CoarseWays ways(planner, 100000);
  const auto start = planner.way(planner.nodeOf(space.index(space.columnOf(1), space.rowOf(1)))).front();
  for (const core::Point2 p : {core::Point2{3.2, 1.0}, core::Point2{3.0, 1.9}, core::Point2{1.1, 1.7}}) {
    const auto node = planner.nodeOf(space.index(space.columnOf(p.x), space.rowOf(p.y)));
    EXPECT_NEAR(ways.lengths(start, {node})[0], planner.cost(node), 1e-9);
  }
}

}  // namespace
}  // namespace slam::paths
