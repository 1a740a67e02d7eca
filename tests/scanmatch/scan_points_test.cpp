#include "libslam/scanmatch/scan_points.h"

#include <gtest/gtest.h>

#include "tests/scanmatch/drawn_rooms.h"

namespace slam::scanmatch {
namespace {

using scanmatch_test::Lidar;
using scanmatch_test::look;
using scanmatch_test::rectangle;

Lidar exactLidar() {
  Lidar lidar;
  lidar.noise_m = 0;
  return lidar;
}

TEST(ScanPoints, HaveTheNormalsOfTheirWallsTowardsTheLidar) {
  core::RandomStream chance(1, "lidar");
  const auto scan = look(rectangle(-2, -2, 3, 2), {}, exactLidar(), chance);
  const auto points = surfacePoints(scan, {});
  int ahead = 0, left = 0;
  for (const auto& point : points) {
    // Away from the corners, where two walls meet in one neighbourhood.
    if (std::abs(point.p.x - 3) < 1e-4 && std::abs(point.p.y) < 1.5) {
      ++ahead;
      EXPECT_NEAR(point.n.x, -1, 1e-3);
    }
    if (std::abs(point.p.y - 2) < 1e-4 && point.p.x < 2.5) {
      ++left;
      EXPECT_NEAR(point.n.y, -1, 1e-3);
    }
  }
  EXPECT_GT(ahead, 20);
  EXPECT_GT(left, 10);
}

TEST(ScanPoints, AreInTheRobotsFrameWhereverTheLidarSits) {
  core::RandomStream chance(1, "lidar");
  Lidar lidar = exactLidar();
  lidar.T_robot_lidar = {-0.5, 0.25, core::kPi / 2};
  const auto points = surfacePoints(look(rectangle(-2, -2, 3, 2), {}, lidar, chance), {});
  ASSERT_FALSE(points.empty());
  for (const auto& point : points) {
    const double to_wall = std::min(
        {std::abs(point.p.x - 3), std::abs(point.p.x + 2), std::abs(point.p.y - 2), std::abs(point.p.y + 2)});
    EXPECT_LT(to_wall, 1e-5);  // ranges are floats
  }
}

TEST(ScanPoints, AreThinnedToTheirSpacing) {
  core::RandomStream chance(1, "lidar");
  const auto scan = look(rectangle(-1, -1, 1, 1), {}, exactLidar(), chance);
  ScanPointOptions options;
  options.spacing_m = 0.2;
  const auto points = surfacePoints(scan, options);
  ASSERT_GT(points.size(), 5U);
  for (size_t i = 1; i < points.size(); ++i) EXPECT_GE(core::distance(points[i - 1].p, points[i].p), 0.2);
}

TEST(ScanPoints, AreTheSameWithoutTheirNormals) {
  core::RandomStream chance(1, "lidar");
  const auto scan = look(rectangle(-2, -2, 3, 2), {}, {}, chance);
  const auto with = surfacePoints(scan, {});
  const auto without = thinnedPoints(scan, {});
  ASSERT_EQ(with.size(), without.size());
  for (size_t i = 0; i < with.size(); ++i) EXPECT_EQ(core::distance(with[i].p, without[i]), 0);
}

TEST(ScanPoints, LeaveOutWhatIsNoReturnAndWhatIsTooFar) {
  core::RandomStream chance(1, "lidar");
  auto scan = look(rectangle(-30, -3, 30, 3), {}, exactLidar(), chance);
  scan.ranges_m[20] = robot::kLostReading;
  ScanPointOptions options;
  options.max_range_m = 5;
  for (const auto& point : surfacePoints(scan, options))
    EXPECT_LE(std::hypot(point.p.x, point.p.y), 5 + 1e-5);
  for (float& range : scan.ranges_m) range = robot::kNoReturn;
  EXPECT_TRUE(surfacePoints(scan, options).empty());
}

}  // namespace
}  // namespace slam::scanmatch
