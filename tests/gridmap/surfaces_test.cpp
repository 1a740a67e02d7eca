#include <gtest/gtest.h>

#include "libslam/gridmap/grid.h"

namespace slam::gridmap {
namespace {

TEST(Grid, ASurfaceIsKeptFinerThanItsCell) {
  lidar::Scan scan;
  scan.step_rad = 0.01, scan.max_range_m = 30;
  scan.ranges_m = {1.237F};
  Grid grid({});
  grid.insert(scanRays(scan, {}), {0, 0.025, 0});
  // 1.237 m lies 0.013 m behind the centre of cell 24, which is at 1.225 m. One unit is 0.05 mm.
  EXPECT_NEAR(grid.at(24, 0)->shift_x * 0.05 / 1024, 0.012, 1e-4);
  EXPECT_NEAR(grid.at(20, 0)->shift_x * 0.05 / 1024, 0.212, 1e-4);
}

TEST(Grid, ASurfaceIsTheMeanOfItsFirstSixteenReturns) {
  lidar::Scan scan;
  scan.step_rad = 0.01, scan.max_range_m = 30;
  Grid grid({});
  for (int i = 0; i < 20; ++i) {
    // 1.210 and 1.230 m in turn; what comes after the sixteenth would move the mean of 1.220 m.
    scan.ranges_m = {i >= 16 ? 1.245F : i % 2 ? 1.21F : 1.23F};
    grid.insert(scanRays(scan, {}), {0, 0.025, 0});
  }
  EXPECT_NEAR(grid.at(24, 0)->shift_x * 0.05 / 1024, -0.005, 2e-4);
  EXPECT_NEAR(grid.at(26, 0)->shift_x * 0.05 / 1024, -0.105, 2e-4);
}

TEST(Grid, AWallThatComesBackIsTheMeanOfItsNewReturns) {
  lidar::Scan scan;
  scan.step_rad = 0.01, scan.max_range_m = 30;
  Grid grid({});
  const auto see = [&](float range_m, int times) {
    scan.ranges_m = {range_m};
    for (int i = 0; i < times; ++i) grid.insert(scanRays(scan, {}), {0, 0.025, 0});
  };
  see(1.205F, 20);
  ASSERT_TRUE(grid.at(24, 0)->occupied());
  see(2, 20);
  ASSERT_FALSE(grid.at(24, 0)->occupied());
  see(1.245F, 20);
  ASSERT_TRUE(grid.at(24, 0)->occupied());
  EXPECT_NEAR(grid.at(24, 0)->shift_x * 0.05 / 1024, 0.02, 2e-4);
}

TEST(Grid, ManyReturnsOfOneScanInACellAreOneHit) {
  lidar::Scan scan;
  scan.step_rad = 0.001, scan.max_range_m = 30;
  scan.ranges_m = {1.22F};
  Grid once({}), often({});
  once.insert(scanRays(scan, {}), {0, 0.025, 0});
  scan.ranges_m = {1.22F, 1.22F, 1.22F, 1.22F};
  often.insert(scanRays(scan, {}), {0, 0.025, 0});
  EXPECT_EQ(often.at(24, 0)->log_odds, once.at(24, 0)->log_odds);
  EXPECT_EQ(often.at(24, 0)->returns, 4) << "of the surface's place";
}

}  // namespace
}  // namespace slam::gridmap
