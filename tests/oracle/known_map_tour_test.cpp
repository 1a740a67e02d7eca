#include "libslam/oracle/known_map_tour.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/world/drawn_plan.h"

namespace slam::oracle {
namespace {

/// 0.1 m cells: a corridor with rooms to its left and right behind narrow doors; the start is in the
/// corridor.
world::Plan rooms() {
  const std::string wall(61, '#'), corridor = "#" + std::string(59, '.') + "#";
  const std::string row =
      "#" + std::string(19, '.') + "#" + std::string(19, '.') + "#" + std::string(19, '.') + "#";
  std::string doors = wall;
  for (const std::size_t at : {3U, 27U, 52U}) doors.replace(at, 8, "........");
  std::vector<std::string> lines = {wall};
  lines.insert(lines.end(), 15, row);
  lines.push_back(doors);
  lines.insert(lines.end(), 10, corridor);
  lines.push_back(doors);
  lines.insert(lines.end(), 15, row);
  lines.push_back(wall);
  return world::drawnPlan(lines, 0.1);
}

TourRequest request(const core::Point2& start) {
  TourRequest request;
  request.start_world = start;
  request.radius_m = 0.25;
  request.max_range_m = 10;
  request.rounds = 40;
  return request;
}

Oracle consult(const world::Plan& plan, const TourRequest& request) {
  return consultOracle(
      plan, metrics::explorableArea(plan, request.start_world, request.radius_m, request.max_range_m),
      request);
}

TEST(Oracle, DrivesWhereTheRobotFitsAndSeesTheShare) {
  const auto plan = rooms();
  const auto asked = request({3.05, 2.15});
  const auto oracle = consult(plan, asked);
  for (const auto* tour : {&oracle.to_90, &oracle.to_99}) {
    ASSERT_TRUE(std::isfinite(tour->length_m));
    EXPECT_GE(tour->curve.back().share, tour->share);
    EXPECT_DOUBLE_EQ(tour->curve.back().path_m, tour->length_m);
    double length_m = 0;
    for (std::size_t i = 1; i < tour->path.size(); ++i) {
      length_m += core::distance(tour->path[i - 1], tour->path[i]);
      for (double s = 0; s <= 1; s += 0.05) {
        const core::Point2 p{tour->path[i - 1].x + s * (tour->path[i].x - tour->path[i - 1].x),
                             tour->path[i - 1].y + s * (tour->path[i].y - tour->path[i - 1].y)};
        // Cells count by their middle: the disc itself may stick out of it by half a diagonal.
        EXPECT_FALSE(world::discCollides(plan, p, asked.radius_m - 0.0708));
      }
    }
    EXPECT_NEAR(length_m, tour->length_m, 1e-6);
  }
  EXPECT_LE(oracle.to_90.length_m, oracle.to_99.length_m);
  EXPECT_LE(oracle.below_90_m, oracle.to_90.length_m);
  EXPECT_LE(oracle.below_99_m, oracle.to_99.length_m);
  // Six rooms of 2 x 1.5 m along 6 m of corridor. To look into the four in the corners is 1.5 m to one end,
  // the whole way to the other, and steps aside; to stand in the middle of all six and come back to the
  // corridor is 20 m.
  EXPECT_GT(oracle.to_99.length_m, 4.0);
  EXPECT_LT(oracle.to_99.length_m, 16.0);
  EXPECT_GT(oracle.below_99_m, 1.0);
}

TEST(Oracle, SaysTheSameEveryTime) {
  const auto plan = rooms();
  const auto a = consult(plan, request({3.05, 2.15})), b = consult(plan, request({3.05, 2.15}));
  EXPECT_EQ(a.to_99.length_m, b.to_99.length_m);
  EXPECT_EQ(a.below_99_m, b.below_99_m);
}

TEST(Oracle, NeedsNoWayWhereAllIsInSight) {
  const auto plan = world::drawnPlan({"#######", "#.....#", "#.....#", "#.....#", "#######"}, 0.5);
  const auto oracle = consult(plan, request({1.75, 1.25}));
  EXPECT_EQ(oracle.to_99.length_m, 0);
  EXPECT_EQ(oracle.below_99_m, 0);
}

TEST(Oracle, HasNothingToSayFromInsideAWall) {
  const auto oracle = consult(rooms(), request({0.05, 0.05}));
  EXPECT_TRUE(std::isnan(oracle.to_99.length_m));
  EXPECT_TRUE(std::isnan(oracle.to_90.length_m));
}

TEST(Oracle, StopsWhenItIsAskedTo) {
  const auto plan = rooms();
  const auto asked = request({3.05, 2.15});
  const auto area = metrics::explorableArea(plan, asked.start_world, asked.radius_m, asked.max_range_m);
  EXPECT_THROW(consultOracle(plan, area, asked, [] { throw std::runtime_error("enough"); }),
               std::runtime_error);
}

}  // namespace
}  // namespace slam::oracle
