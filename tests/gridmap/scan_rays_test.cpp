#include "libslam/gridmap/scan_rays.h"

#include <gtest/gtest.h>

#include <cmath>

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

TEST(ScanRays, NormalsPointFromTheSurfaceToTheLidar) {
  lidar::Scan scan;
  scan.first_angle_rad = 0.6, scan.step_rad = 0.02, scan.max_range_m = 20;
  scan.T_robot_lidar = {0.5, 0, 0};
  for (size_t i = 0; i < 5; ++i) scan.ranges_m.push_back(static_cast<float>(2 / std::cos(scan.angle(i))));
  const auto angleOf = [](const core::Point2& p) { return std::atan2(p.y, p.x); };
  const auto rays = scanRays(scan, {}).rays;
  for (size_t i = 1; i < 4; ++i) EXPECT_NEAR(std::abs(angleOf(rays[i].normal)), core::kPi, 1e-5) << i;
  for (const size_t i : {0, 4})
    EXPECT_NEAR(core::angleDifference(angleOf(rays[i].normal), scan.angle(i) + core::kPi), 0, 1e-5) << i;

  scan.ranges_m[3] = 9;  // another surface
  EXPECT_NEAR(core::angleDifference(angleOf(scanRays(scan, {}).rays[2].normal), scan.angle(2) + core::kPi), 0,
              1e-5);
  scan.ranges_m[3] = lidar::kNoReturn;
  EXPECT_EQ(scanRays(scan, {}).rays[3].normal.x, 0);
}

}  // namespace
}  // namespace slam::gridmap
