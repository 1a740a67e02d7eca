#include "libslam/sim/recent_path.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/random.h"

namespace slam::sim {
namespace {

void expectPose(const core::Pose2& found, const core::Pose2& expected, double tolerance = 0) {
  EXPECT_NEAR(found.x, expected.x, tolerance);
  EXPECT_NEAR(found.y, expected.y, tolerance);
  EXPECT_NEAR(found.phi, expected.phi, tolerance);
}

TEST(RecentPath, IsThePresentPoseWithoutAPast) {
  const core::Pose2 now{1, 2, 3};
  expectPose(RecentPath(0).poseBefore(now, 1), now);
  expectPose(RecentPath(5).poseBefore(now, 1), now);
  expectPose(RecentPath(5).poseBefore(now, 0), now);
}

TEST(RecentPath, FollowsTheArcsBack) {
  RecentPath path(100);
  core::RandomStream random(1, "recent path test");
  core::Pose2 T_world_robot{1, 1, 0.5};
  std::vector<core::Pose2> every_quarter = {T_world_robot};
  for (int i = 0; i < 50; ++i) {
    const robot::Command command{random.uniform(-1, 1), random.uniform(-1, 1), 1.0};
    path.add(T_world_robot, command, 1.0);
    for (const double elapsed_s : {0.25, 0.5, 0.75, 1.0})
      every_quarter.push_back(T_world_robot * robot::driveMotion(command, elapsed_s));
    T_world_robot = every_quarter.back();
  }
  for (size_t i = 0; i < every_quarter.size(); ++i) {
    const double ago_s = 0.25 * static_cast<double>(every_quarter.size() - 1 - i);
    expectPose(path.poseBefore(T_world_robot, ago_s), every_quarter[i], 1e-12);
  }
  expectPose(path.poseBefore(T_world_robot, 1000), every_quarter.front());  // it stood there before
}

TEST(RecentPath, StandsStillAfterAnObstacle) {
  RecentPath path(10);
  path.add({0, 0, 0}, {1, 0, 0.5}, 2);  // half a metre, then against a wall for 1.5 s
  const core::Pose2 now{0.5, 0, 0};
  expectPose(path.poseBefore(now, 1), now);
  expectPose(path.poseBefore(now, 1.5), now);
  expectPose(path.poseBefore(now, 1.75), {0.25, 0, 0});
  expectPose(path.poseBefore(now, 2), {0, 0, 0});
}

TEST(RecentPath, RemembersAsLongAsItSays) {
  RecentPath path(1.0);
  for (int i = 0; i < 100; ++i) path.add({0.1 * i, 0, 0}, {1, 0, 0.1}, 0.1);
  for (double ago_s = 0.05; ago_s < 1; ago_s += 0.1)
    expectPose(path.poseBefore({10, 0, 0}, ago_s), {10 - ago_s, 0, 0}, 1e-12);
}

}  // namespace
}  // namespace slam::sim
