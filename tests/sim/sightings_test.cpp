#include "libslam/sim/sightings.h"

#include <gtest/gtest.h>

#include "libslam/sim/simulator.h"

namespace slam::sim {
namespace {

/// 10 x 4 m with a wall across the middle that leaves the upper metre open.
world::Plan plan() {
  world::Plan plan;
  plan.name = "halves";
  plan.columns = 200;
  plan.rows = 80;
  plan.cells.assign(size_t{200} * 80, world::Cell::kFree);
  for (int row = 0; row < 60; ++row)
    plan.cells[static_cast<size_t>(row) * 200 + 100] = world::Cell::kOccupied;
  return plan;
}

TEST(Sightings, AWallHidesARobotButNotTheOneRoundTheCorner) {
  const auto halves = plan();
  const auto seen = sightings(halves, {4, 1, core::kPi / 2}, {{2, 1}, {7, 1}, {5.4, 1}, {4, 1}});
  ASSERT_EQ(seen.size(), 3U);
  EXPECT_EQ(seen[0].robot, 0U);
  EXPECT_NEAR(seen[0].p_robot.x, 0, 1e-12);
  EXPECT_NEAR(seen[0].p_robot.y, 2, 1e-12);                              // on its left
  EXPECT_EQ(seen[1].robot, 2U);                                          // behind the wall, 1.4 m away
  EXPECT_EQ(sightings(halves, {0.5, 3.5, 0}, {{9.5, 3.5}}).size(), 0U);  // 9 m
  EXPECT_EQ(sightings(halves, {2, 3.5, 0}, {{9, 3.5}}).size(), 1U);
}

TEST(Simulator, OtherRobotsAreSeenAndBumpedInto) {
  const auto halves = plan();
  lidar::LidarOptions lidar;
  lidar.sigma_m = 0;
  const robot::RobotOptions robot;
  Simulator simulator(halves, robot, lidar, {}, {1, 2, 0}, 1);
  const auto ahead = [](const lidar::Scan& scan) { return scan.ranges_m[scan.ranges_m.size() / 2]; };
  EXPECT_NEAR(ahead(simulator.sense().scan), 4.0F, 0.02);
  simulator.setOthers({{{2.5, 2}, 0.3}});
  EXPECT_NEAR(ahead(simulator.sense().scan), 1.2F, 0.02);
  const auto hit = simulator.step({0.5, 0, 4});
  EXPECT_TRUE(hit.collided);
  ASSERT_EQ(simulator.collisions().size(), 1U);
  EXPECT_TRUE(simulator.collisions()[0].with_robot);
  EXPECT_NEAR(simulator.truth().x, 2.5 - 0.3 - robot::circumscribedRadius(robot), 0.002);
  simulator.setOthers({});
  EXPECT_TRUE(simulator.step({0.5, 0, 10}).collided);
  EXPECT_FALSE(simulator.collisions()[1].with_robot);
}

}  // namespace
}  // namespace slam::sim
