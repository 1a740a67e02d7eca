// One step of bundle adjustment in a drawn corner, and what it costs to be off.
#include "libslam/bundle/surface_bundle.h"

#include <gtest/gtest.h>

#include "tests/bundle/seen_points.h"

namespace slam::bundle {
namespace {

using namespace test_points;

/// A corner seen from where the robot was, and the same points from where it is said to have been.
keyframes::KeyframeMap corner(const core::Pose2& T_map_robot, const core::Pose2& T_said) {
  keyframes::KeyframeMap map{keyframes::GraphOptions{}};
  Points points = alongY(3.04, -2, 3);
  for (const auto& point : alongX(3.04, -2, 3)) points.push_back(point);
  addSeen(map, {0, 0, 0}, points, -1);
  const core::Pose2 T_robot_map = core::between(T_map_robot, core::Pose2{0, 0, 0});
  for (auto& point : points) {
    const core::Pose2 at = T_robot_map * core::Pose2{point.x, point.y, 0};
    const auto turned = core::Pose2{0, 0, T_robot_map.phi} * core::Pose2{point.along_x, point.along_y, 0};
    point = {static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(turned.x),
             static_cast<float>(turned.y)};
  }
  addSeen(map, T_said, points, 0);
  return map;
}

TEST(SurfaceBundle, FindsWhereAKeyframeWas) {
  const core::Pose2 T_robot{1, 0.5, 0.4}, T_said{1.008, 0.494, 0.403};
  const auto map = corner(T_robot, T_said);
  const SurfaceBundle bundle(map, SharedSurfaces(map));
  const auto step = bundle.step();
  ASSERT_EQ(step.size(), 2U);
  EXPECT_EQ(step[0], Eigen::Vector3d::Zero());
  EXPECT_NEAR(step[1].x(), T_robot.x - T_said.x, 1e-3);
  EXPECT_NEAR(step[1].y(), T_robot.y - T_said.y, 1e-3);
  EXPECT_NEAR(step[1].z(), T_robot.phi - T_said.phi, 3e-4);
}

TEST(SurfaceBundle, CountsWhatPointsAreOffBy) {
  const core::Pose2 T_robot{1, 0.5, 0.4};
  const auto right = corner(T_robot, T_robot), off = corner(T_robot, {1.01, 0.5, 0.4});
  const double chi2 = SurfaceBundle(right, SharedSurfaces(right)).chi2();
  EXPECT_NEAR(chi2, 0, 1e-3);
  EXPECT_GT(SurfaceBundle(off, SharedSurfaces(off)).chi2(), 1);
}

// All rotations turn about the map's origin: far from it nothing may be lost by rounding.
TEST(SurfaceBundle, IsTheSameFarFromTheOrigin) {
  const core::Pose2 T_robot{1, 0.5, 0.4}, T_said{1.008, 0.494, 0.403}, T_far{4096, -2048, 0};
  auto near = corner(T_robot, T_said), far = corner(T_robot, T_said);
  for (int k = 0; k < 2; ++k) {
    const core::Pose2 T = far.pose(k);
    far.graph().setPose(k, {T_far.x + T.x, T_far.y + T.y, T.phi});
  }
  const auto here = SurfaceBundle(near, SharedSurfaces(near)).step(),
             there = SurfaceBundle(far, SharedSurfaces(far)).step();
  ASSERT_EQ(there.size(), 2U);
  EXPECT_NEAR((here[1] - there[1]).norm(), 0, 5e-4);
}

// On known ground the oldest keyframe gives way to a newer one, and keeps no points.
TEST(SurfaceBundle, HoldsAKeyframeByItsMatchToOneWithoutPoints) {
  keyframes::KeyframeMap map{keyframes::GraphOptions{}};
  addSeen(map, {0, 0, 0}, {}, -1);
  addSeen(map, {1, 0, 0}, alongY(3.04, -2, 3), 0);
  map.graph().setPose(1, {1.05, 0, 0});  // the match found it there, and not where odometry had it
  map.tie(1, {0}, map.pose(1), 1e6 * Eigen::Matrix3d::Identity(), 1);
  map.keyframes()[0].is_retired = true;
  const auto step = SurfaceBundle(map, SharedSurfaces(map)).step();
  ASSERT_EQ(step.size(), 2U);
  EXPECT_NEAR(step[1].x(), 0, 1e-3);
}

TEST(SurfaceBundle, LeavesPartsWithoutAKnownPlaceWhereTheyAre) {
  const core::Pose2 T_robot{1, 0.5, 0.4};
  auto map = corner(T_robot, {1.01, 0.5, 0.4});
  map.beginPart(1);
  const auto step = SurfaceBundle(map, SharedSurfaces(map)).step();
  ASSERT_EQ(step.size(), 2U);
  EXPECT_EQ(step[1], Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace slam::bundle
