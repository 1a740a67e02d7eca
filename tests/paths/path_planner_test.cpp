#include "libslam/paths/path_planner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "tests/paths/drawn_map.h"

namespace slam::paths {
namespace {

/// Every free cell admits the robot, a node is a cell, and nothing costs more than its length.
PlannerOptions pointRobot() {
  PlannerOptions options;
  options.radius_m = options.comfort_m = 0.1;
  options.node_m = 1;
  options.look_m = 0;
  return options;
}

PathPlanner::Node nodeAt(const PathPlanner& planner, const FreeSpace& space, double x, double y) {
  return planner.nodeOf(space.index(space.columnOf(x), space.rowOf(y)));
}

TEST(PathPlanner, FindsTheShortestWayAsTheSearchOverAllCellsDoes) {
  core::RandomStream random(1, "maze");
  for (int trial = 0; trial < 5; ++trial) {
    gridmap::OccupancyRaster map;
    map.columns = 14, map.rows = 11, map.resolution_m = 1;
    for (int i = 0; i < map.columns * map.rows; ++i)
      map.occupancy.push_back(i != 0 && random.chance(0.35) ? 0.9F : 0.1F);
    const auto space = readFreeSpace(map);
    const PathPlanner planner(space, pointRobot(), {0.5, 0.5});
    // Bellman's relaxation until nothing changes: slow and plain.
    std::vector<double> cost(space.state.size(), 1e9);
    cost[space.index(1, 1)] = 0;
    for (bool changed = true; changed;) {
      changed = false;
      for (int row = 1; row <= map.rows; ++row)
        for (int column = 1; column <= map.columns; ++column)
          for (int dr = -1; dr <= 1; ++dr)
            for (int dc = -1; dc <= 1; ++dc) {
              const size_t from = space.index(column + dc, row + dr), to = space.index(column, row);
              if (space.state[from] != kFreeCell || space.state[to] != kFreeCell) continue;
              const double step = dr && dc ? 1.4 : dr || dc ? 1.0 : 0.0;
              if (cost[from] + step < cost[to] - 1e-9) cost[to] = cost[from] + step, changed = true;
            }
    }
    for (int row = 1; row <= map.rows; ++row)
      for (int column = 1; column <= map.columns; ++column) {
        const auto node = planner.nodeOf(space.index(column, row));
        const double expected = cost[space.index(column, row)];
        ASSERT_EQ(planner.isReached(node), expected < 1e8) << column << ", " << row;
        if (planner.isReached(node)) {
          ASSERT_NEAR(planner.cost(node), expected, 1e-9);
        }
      }
  }
}

TEST(PathPlanner, DoesNotReachAPocketBehindWallsNorTheUnknown) {
  const auto space = readFreeSpace(drawnMap({"#######", "#..#..#", "#..#..?", "#######"}));
  const PathPlanner planner(space, pointRobot(), {1.5, 1.5});
  EXPECT_TRUE(planner.isReached(nodeAt(planner, space, 2.5, 2.5)));
  for (const double x : {3.5, 4.5, 5.5, 6.5}) EXPECT_FALSE(planner.isReached(nodeAt(planner, space, x, 1.5)));
  EXPECT_EQ(planner.reachedCount(), 4u);
}

TEST(PathPlanner, DrivesThroughTheUnknownOnlyWhenOptimistic) {
  const auto space = readFreeSpace(drawnMap({"#######", "#..?..#", "#..?..#", "#######"}));
  auto options = pointRobot();
  EXPECT_FALSE(PathPlanner(space, options, {1.5, 1.5}).isReached(space.columns + 3));
  const PathPlanner careful(space, options, {1.5, 1.5});
  EXPECT_FALSE(careful.isReached(nodeAt(careful, space, 5.5, 1.5)));
  options.optimistic = true;
  const PathPlanner bold(space, options, {1.5, 1.5});
  EXPECT_TRUE(bold.isReached(nodeAt(bold, space, 5.5, 1.5)));
}

/// Two rooms of 2 m x 2.6 m with a door of 0.9 m at the bottom of the wall between them.
FreeSpace twoRooms() {
  return readFreeSpace(
      enlarged({"##########################",  // 1 m is 5 characters of 4 cells of 5 cm
                "#..........##............#", "#..........##............#", "#..........##............#",
                "#..........##............#", "#..........##............#", "#........................#",
                "#........................#", "#........................#", "#........................#",
                "#..........##............#", "#..........##............#", "##########################"},
               4, 0.05));
}

TEST(PathPlanner, PassesADoorInItsMiddle) {
  const auto space = twoRooms();
  PlannerOptions options;
  options.radius_m = 0.333;
  const PathPlanner planner(space, options, {1.0, 1.9});
  const auto goal = nodeAt(planner, space, 4.4, 1.9);
  ASSERT_TRUE(planner.isReached(goal));
  const auto path = planner.shortened(planner.way(goal));
  EXPECT_LT(path.size(), 12u);
  core::Point2 from{1.0, 1.9};
  bool crossed = false;
  for (const auto& to : path) {
    for (double s = 0; s <= 1; s += 0.01) {
      const core::Point2 p{from.x + s * (to.x - from.x), from.y + s * (to.y - from.y)};
      if (p.x < 2.4 || p.x > 2.6) continue;  // the door, y from 0.6 to 1.4
      crossed = true;
      EXPECT_NEAR(p.y, 1.0, 0.08);  // of 0.07 m to either side that the radius leaves
    }
    from = to;
  }
  EXPECT_TRUE(crossed);
  EXPECT_NEAR(path.back().x, 4.4, 0.15);                             // a node's side and its best cell
  EXPECT_GT(planner.cost(goal), planner.length(planner.way(goal)));  // the door is dear
}

TEST(PathPlanner, DoesNotFitThroughADoorThatIsTooNarrowButLooksIn) {
  const auto space = twoRooms();
  PlannerOptions options;
  options.radius_m = 0.45;
  const PathPlanner planner(space, options, {1.0, 1.9});
  EXPECT_FALSE(planner.isReached(nodeAt(planner, space, 4.4, 1.9)));
  const auto access = planner.accessOf(nodeAt(planner, space, 2.5, 1.0));
  ASSERT_TRUE(access);  // in the door, 0.6 m from where it can stand
  EXPECT_LT(planner.pointOf(*access).x, 2.2);
  EXPECT_FALSE(planner.accessOf(nodeAt(planner, space, 4.4, 1.9)));
}

// A node is several cells, and the best of its cells may lie behind a wall that is thinner than a node.
TEST(PathPlanner, StepsThroughNoThinWall) {
  PlannerOptions options;
  options.radius_m = options.comfort_m = 0.05;
  options.look_m = 0;
  for (const int per_node : {2, 3, 4})
    for (int wall = 9; wall < 13; ++wall) {
      options.node_m = 0.1 * per_node;
      std::string line(24, '.');
      line.front() = line.back() = line[static_cast<size_t>(wall)] = '#';
      std::vector<std::string> lines(16, line);
      lines.front() = lines.back() = std::string(24, '#');
      const auto space = readFreeSpace(drawnMap(lines, 0.1));
      const PathPlanner planner(space, options, {0.5, 0.8});
      EXPECT_TRUE(planner.isReached(nodeAt(planner, space, 0.3, 1.2)));
      EXPECT_FALSE(planner.isReached(nodeAt(planner, space, 2.0, 0.8)))
          << per_node << " cells a node, wall in column " << wall;
    }
}

TEST(PathPlanner, LeavesAPlaceThatDoesNotAdmitTheRobot) {
  const auto space = twoRooms();
  PlannerOptions options;
  options.radius_m = 0.333;
  const core::Point2 robot{0.3, 2.3};  // 0.1 m from two walls
  const PathPlanner planner(space, options, robot);
  ASSERT_TRUE(planner.hasStart());
  const auto goal = nodeAt(planner, space, 1.2, 1.2);
  ASSERT_TRUE(planner.isReached(goal));
  const auto path = planner.shortened(planner.way(goal));
  EXPECT_LT(core::distance(path.front(), robot), 0.8);
  EXPECT_GE(path.size(), 2u);
}

TEST(PathPlanner, HasNoStartInsideOfNothingKnown) {
  const auto space = readFreeSpace(drawnMap({"????", "????"}));
  EXPECT_FALSE(PathPlanner(space, pointRobot(), {1, 1}).hasStart());
  EXPECT_FALSE(PathPlanner(space, pointRobot(), {100, 1}).hasStart());
  EXPECT_FALSE(PathPlanner(space, pointRobot(), {std::nan(""), 1}).hasStart());
  const auto walled = readFreeSpace(drawnMap({"#####", "#?#.#", "#####"}));
  EXPECT_FALSE(PathPlanner(walled, pointRobot(), {1.5, 1.5}).hasStart());  // free only behind a wall
}

TEST(PathPlanner, RefusesSenselessClearances) {
  const auto space = readFreeSpace(drawnMap({"."}));
  auto options = pointRobot();
  options.comfort_m = 0.05;
  EXPECT_THROW(PathPlanner(space, options, {}), core::ContractError);
}

/// Two rooms of 2 m at 0.05 m, joined by a gap through 0.1 m of wall; from x = 0 to 4.1, y = 0 to 2.
gridmap::OccupancyRaster roomsWithGap(int gap_cells) {
  std::vector<std::string> lines(44, "##" + std::string(40, '.') + "##" + std::string(40, '.') + "##");
  lines[0] = lines[1] = lines[42] = lines[43] = std::string(86, '#');
  for (int row = 2; row < 42; ++row) {
    const int from_gap = row - (22 - gap_cells / 2);
    if (from_gap >= 0 && from_gap < gap_cells) lines[static_cast<size_t>(row)].replace(42, 2, "..");
  }
  return drawnMap(lines, 0.05);
}

// A robot of radius 0.283 m fits through 13 cells of 0.05 m by the map, and with a cell less on each side
// through 11.
TEST(PathPlanner, LeavesATightPlaceOnlyWhereTheRobotStandsInIt) {
  const auto space = readFreeSpace(roomsWithGap(11));
  const auto reachesTheOtherRoom = [&](double radius_m, bool tight_start, const core::Point2& robot) {
    PlannerOptions options;
    options.radius_m = radius_m;
    options.look_m = 0;
    options.tight_start = tight_start;
    const PathPlanner planner(space, options, robot);
    EXPECT_TRUE(planner.hasStart());
    return planner.isReached(nodeAt(planner, space, 3.5, 1.0));
  };
  EXPECT_FALSE(reachesTheOtherRoom(0.283, false, {1.6, 1.05}));
  EXPECT_TRUE(reachesTheOtherRoom(0.283, true, {1.6, 1.05}));
  EXPECT_FALSE(reachesTheOtherRoom(0.283, true, {0.5, 1.05}));  // 1.6 m before the gap
  EXPECT_FALSE(reachesTheOtherRoom(0.333, true, {1.6, 1.05}));  // that is more than a cell too much
}

}  // namespace
}  // namespace slam::paths
