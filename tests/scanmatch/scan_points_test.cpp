#include "libslam/scanmatch/scan_points.h"

#include <gtest/gtest.h>

#include <algorithm>

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
  for (size_t i = 1; i < points.size(); ++i) EXPECT_GE(core::distance(points[i - 1].p, points[i].p), 0.18);
  for (size_t i = 1; i < points.size(); ++i) EXPECT_LE(core::distance(points[i - 1].p, points[i].p), 0.3);
}

// Were points preferred that lie far from the one kept before, a wall would be turned: out where the ranges
// of neighbouring beams grow, in where they shrink.
TEST(ScanPoints, AreThinnedWithoutRegardToTheirNoise) {
  Lidar lidar;
  lidar.noise_m = 0.02;
  core::RandomStream chance(1, "lidar");
  const std::vector<scanmatch_test::Wall> wall{{{2, -3}, {2, 3}}};
  double sum_right_m = 0, sum_left_m = 0;
  int right = 0, left = 0;
  for (int i = 0; i < 300; ++i)
    for (const auto& point : patchPoints(look(wall, {}, lidar, chance), {})) {
      if (point.y < -0.5) sum_right_m += point.x - 2, ++right;
      if (point.y > 0.5) sum_left_m += point.x - 2, ++left;
    }
  ASSERT_GT(right, 3000);
  EXPECT_NEAR(sum_right_m / right, 0, 0.001);
  EXPECT_NEAR(sum_left_m / left, 0, 0.001);
}

TEST(ScanPoints, AreTheSameWithPatchesInsteadOfNormals) {
  core::RandomStream chance(1, "lidar");
  const auto scan = look(rectangle(-2, -2, 3, 2), {}, {}, chance);
  const auto with_normals = surfacePoints(scan, {});
  const auto patches = patchPoints(scan, {});
  ASSERT_EQ(with_normals.size(), patches.size());
  // Floats: a metre to 1e-7.
  for (size_t i = 0; i < patches.size(); ++i)
    EXPECT_LT(core::distance(with_normals[i].p, position(patches[i])), 1e-6);
}

TEST(ScanPoints, StandForTheWallUpToHalfWayToTheNextBeam) {
  core::RandomStream chance(1, "lidar");
  const auto scan = look(rectangle(-20, -1, 20, 1), {}, exactLidar(), chance);
  ScanPointOptions options;
  options.max_range_m = 8;
  int far = 0;
  for (const auto& patch : patchPoints(scan, options)) {
    if (std::abs(patch.x) < 4) continue;
    ++far;
    // Along the wall, and as far as the beams lie apart there: x = 1 / tan(angle).
    const double step_m = (patch.x * patch.x + 1) * scan.step_rad;
    EXPECT_LT(std::abs(patch.along_y), 1e-4);
    EXPECT_NEAR(std::abs(patch.along_x), step_m / (2 * std::sqrt(3.0)), 0.2 * step_m);
  }
  EXPECT_GT(far, 8);
}

// Two neighbouring returns a centimetre apart and as noisy tell no direction.
TEST(ScanPoints, LieAlongTheirWallHoweverCloseTheBeams) {
  Lidar lidar;
  lidar.fov_rad = core::kPi / 2, lidar.beams = 181, lidar.noise_m = 0.02;
  core::RandomStream chance(1, "lidar");
  int all = 0, along = 0;
  for (int i = 0; i < 50; ++i)
    for (const auto& point : patchPoints(look({{{1.5, -3}, {1.5, 3}}}, {}, lidar, chance), {})) {
      if (std::abs(point.y) > 1) continue;
      ++all, along += std::abs(point.along_y) > 2 * std::abs(point.along_x);
    }
  ASSERT_GT(all, 500);
  EXPECT_GT(along, 0.95 * all);
}

TEST(ScanPoints, StandForWhatTheirBeamLeavesOpenSidewaysWhereNoNeighbourIsNear) {
  lidar::Scan scan;
  scan.first_angle_rad = -0.01, scan.step_rad = 0.01;
  scan.max_range_m = 30;
  scan.ranges_m = {12, 4, 11};
  const auto patches = patchPoints(scan, {});
  ASSERT_EQ(patches.size(), 3U);
  EXPECT_NEAR(patches[1].along_x, 0, 1e-6);
  EXPECT_NEAR(patches[1].along_y, 4 * 0.01 / (2 * std::sqrt(3.0)), 1e-6);
}

// Returns metres apart along a bare corridor are no posts that stand across it.
TEST(ScanPoints, LieAlongTheirWallHoweverGrazingTheBeams) {
  Lidar lidar;
  lidar.beams = 361, lidar.max_range_m = 30;
  core::RandomStream chance(1, "lidar");
  int far = 0, along = 0;
  for (int i = 0; i < 20; ++i)
    for (const auto& patch : patchPoints(look(rectangle(-50, -1, 50, 1), {}, lidar, chance), {})) {
      if (patch.x < 13) continue;
      ++far, along += std::abs(patch.along_x) > 5 * std::abs(patch.along_y);
    }
  ASSERT_GT(far, 60);
  EXPECT_GT(along, 0.7 * far);
}

TEST(ScanPoints, TurnWithTheirPatches) {
  const PatchPoint turned = core::Pose2{1, 2, core::kPi / 2} * PatchPoint{3, 4, 0.5F, 0.25F};
  EXPECT_NEAR(turned.x, -3, 1e-6);
  EXPECT_NEAR(turned.y, 5, 1e-6);
  EXPECT_NEAR(turned.along_x, -0.25, 1e-6);
  EXPECT_NEAR(turned.along_y, 0.5, 1e-6);
}

TEST(ScanPoints, LeaveOutWhatIsNoReturnAndWhatIsTooFar) {
  core::RandomStream chance(1, "lidar");
  auto scan = look(rectangle(-30, -3, 30, 3), {}, exactLidar(), chance);
  scan.ranges_m[20] = lidar::kLostReading;
  ScanPointOptions options;
  options.max_range_m = 5;
  for (const auto& point : surfacePoints(scan, options))
    EXPECT_LE(std::hypot(point.p.x, point.p.y), 5 + 1e-5);
  for (float& range : scan.ranges_m) range = lidar::kNoReturn;
  EXPECT_TRUE(surfacePoints(scan, options).empty());
}

}  // namespace
}  // namespace slam::scanmatch
