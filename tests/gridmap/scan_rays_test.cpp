#include "libslam/gridmap/scan_rays.h"

#include <gtest/gtest.h>

namespace slam::gridmap {
namespace {

/// Four beams, from straight ahead to the left, a quarter of a turn apart: a return, no return, a lost
/// reading, a far return.
lidar::Scan fourBeams() {
  lidar::Scan scan;
  scan.step_rad = core::kPi / 2, scan.max_range_m = 20;
  scan.ranges_m = {1.0F, lidar::kNoReturn, lidar::kLostReading, 15.0F};
  return scan;
}

TEST(ScanRays, EndOnTheSideThatTheBeamPointsTo) {
  auto scan = fourBeams();
  scan.T_robot_lidar = {0.5, 0.25, 0};
  scan.ranges_m = {1, 2, 3, 4};
  const auto rays = scanRays(scan, {});
  EXPECT_EQ(rays.origin.x, 0.5);
  EXPECT_EQ(rays.origin.y, 0.25);
  ASSERT_EQ(rays.rays.size(), 4U);
  EXPECT_NEAR(rays.rays[0].end.x, 1.5, 1e-12);
  EXPECT_NEAR(rays.rays[1].end.y, 2.25, 1e-12);
  EXPECT_NEAR(rays.rays[2].end.x, -2.5, 1e-12);
  EXPECT_NEAR(rays.rays[3].end.y, -3.75, 1e-12);
}

TEST(ScanRays, FollowTheLidarsMount) {
  auto scan = fourBeams();
  scan.T_robot_lidar.phi = core::kPi / 2;
  EXPECT_NEAR(scanRays(scan, {}).rays[0].end.y, 1, 1e-12);
}

TEST(ScanRays, FarReturnsAndNoReturnsClearAndMarkNothing) {
  const auto rays = scanRays(fourBeams(), {10, true}).rays;
  ASSERT_EQ(rays.size(), 3U);  // the lost reading says nothing
  EXPECT_TRUE(rays[0].hit);
  EXPECT_FALSE(rays[1].hit);
  EXPECT_NEAR(rays[1].end.y, 10, 1e-12);
  EXPECT_FALSE(rays[2].hit);
  EXPECT_NEAR(rays[2].end.y, -10, 1e-12);
  EXPECT_EQ(scanRays(fourBeams(), {10, false}).rays.size(), 2U);
}

}  // namespace
}  // namespace slam::gridmap
