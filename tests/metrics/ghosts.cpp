#include "libslam/metrics/ghosts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libslam/core/error.h"
#include "tests/metrics/drawn.h"

namespace slam::metrics {
namespace {

using core::Point2;
using world::Cell;
using world::CellMap;
using world::Plan;

/// An empty hall of 4 x 4 m within walls, of which all is seen.
Plan hall() {
  std::vector<std::string> picture(40, "#" + std::string(38, '.') + "#");
  picture.front() = picture.back() = std::string(40, '#');
  return drawn(picture);
}

SeenMask allSeen(const Plan& plan) {
  SeenMask seen;
  seen.columns = plan.columns, seen.rows = plan.rows;
  for (const Cell cell : plan.cells) {
    seen.wall.push_back(cell == Cell::kOccupied);
    seen.free.push_back(cell == Cell::kFree);
  }
  return seen;
}

void occupy(CellMap& map, int column, int row) {
  map.cells[static_cast<size_t>(row) * map.columns + column] = Cell::kOccupied;
}

double shareOf(const CellMap& map, const std::vector<Point2>& people, const core::Pose2& T_world_map = {}) {
  return ghostShare(hall(), allSeen(hall()), people, map, T_world_map, 0.1);
}

TEST(Ghosts, AreTheShareOfTheGroundUnderPeopleThatIsOccupied) {
  CellMap map = hall();
  EXPECT_DOUBLE_EQ(shareOf(map, {{2, 2}}), 0);
  occupy(map, 20, 20);
  // Of 0.1 m, 32 have their centre within 0.35 m of a corner between four of them.
  const double one = shareOf(map, {{2, 2}});
  EXPECT_NEAR(one, 1.0 / 32, 1e-9);
  EXPECT_DOUBLE_EQ(shareOf(map, {{2, 2}, {2, 2}}), one) << "somebody who waits";
  EXPECT_NEAR(shareOf(map, {{2, 2}, {3, 3}}), one / 2, 1e-9);
  EXPECT_DOUBLE_EQ(shareOf(map, {{1, 1}}), 0) << "where nobody was it is no ghost";
}

TEST(Ghosts, AreNoWallsThatAreDrawnALittleOff) {
  CellMap map = hall();
  for (int row = 0; row < map.rows; ++row) occupy(map, 1, row);
  EXPECT_DOUBLE_EQ(shareOf(map, {{0.3, 2}}), 0);
  for (int row = 0; row < map.rows; ++row) occupy(map, 2, row);
  EXPECT_GT(shareOf(map, {{0.3, 2}}), 0.1);
}

TEST(Ghosts, AreLookedForWhereThePlanWasSeen) {
  CellMap map = hall();
  occupy(map, 20, 20);
  SeenMask seen = allSeen(hall());
  seen.free.assign(seen.free.size(), false);
  EXPECT_TRUE(std::isnan(ghostShare(hall(), seen, {{2, 2}}, map, {}, 0.1)));
  EXPECT_TRUE(std::isnan(shareOf(map, {})));
  EXPECT_TRUE(std::isnan(shareOf(map, {{50, 50}, {-1e300, 1e300}})));
  EXPECT_TRUE(std::isnan(shareOf(map, {{2, 2}}, {std::numeric_limits<double>::quiet_NaN(), 0, 0})));
}

TEST(Ghosts, GoThroughTheAlignment) {
  CellMap map = hall();
  occupy(map, 20, 10);  // at (2.05, 1.05) in the map's frame
  // Turned by a quarter and moved by (3, 1): there (-1.05, 2.05) + (3, 1).
  const core::Pose2 T_world_map{3, 1, core::kPi / 2};
  EXPECT_GT(shareOf(map, {{1.95, 3.05}}, T_world_map), 0.02);
  EXPECT_DOUBLE_EQ(shareOf(map, {{1, 2.2}}, T_world_map), 0);
}

TEST(Ghosts, MayHaveSmallerCells) {
  CellMap fine = drawn(std::vector<std::string>(80, std::string(80, '.')), 0.05);
  for (const int column : {40, 41})
    for (const int row : {40, 41}) occupy(fine, column, row);
  EXPECT_NEAR(shareOf(fine, {{2, 2}}), 1.0 / 32, 1e-9);
}

TEST(Ghosts, NeedTheMaskOfThePlan) {
  SeenMask seen = allSeen(hall());
  --seen.columns;
  EXPECT_THROW(ghostShare(hall(), seen, {{2, 2}}, hall(), {}, 0.1), core::ContractError);
  EXPECT_THROW(ghostShare(hall(), allSeen(hall()), {{2, 2}}, hall(), {}, -1), core::ContractError);
}

}  // namespace
}  // namespace slam::metrics
