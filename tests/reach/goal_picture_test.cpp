#include "libslam/reach/goal_picture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libslam/reach/goal_methods.h"
#include "libslam/resources/file_hash.h"
#include "libslam/testing/temp_folder.h"
#include "libslam/truth/carry_file.h"

namespace slam::reach {
namespace {

TEST(StrategicOverlay, HasTheOriginalFiguresAndOnlyForItsMethod) {
  const goals::NavigateOptions options;
  robot::RobotOptions robot;
  robot.side_m = 0.1;  // fits into the original stop radius
  const auto overlay = strategicOverlay("lidar_bug", options, robot, {});
  ASSERT_TRUE(overlay);
  EXPECT_EQ(overlay->stop_radius_m, options.lidar_bug.stop_radius_m);
  ASSERT_EQ(overlay->directions_rad.size(), 5U);
  const double expected_deg[] = {0, 37, 89, -89, -37};
  for (size_t i = 0; i < 5; ++i)
    EXPECT_NEAR(core::radToDeg(overlay->directions_rad[i]), expected_deg[i], 0.7) << i;
  robot.side_m = 1;
  EXPECT_GT(strategicOverlay("lidar_bug", options, robot, {})->stop_radius_m, std::sqrt(0.5));
  for (const std::string other : {"bug1", "tangent"})
    EXPECT_FALSE(strategicOverlay(other, options, robot, {}));
}

TEST(GoalPicture, ShowsTheOverlayOfLidarBugAlone) {
  const testing::TempFolder folder;
  ReachGoalRequest request;
  request.plan.name = "room";
  request.plan.columns = 60, request.plan.rows = 40;
  request.plan.cells.assign(2400, world::Cell::kFree);
  for (int column = 0; column < 60; ++column)
    request.plan.cells[static_cast<size_t>(column)] = world::Cell::kOccupied;
  request.p_world_goal = {2.5, 1};
  GoalRun run;
  run.truth = {{0, {0.5, 1, 0}}, {1, {1, 1, 0}}, {2, {1.5, 1, 0}}};
  run.changes = {{0, "", "DRIVE FORWARD", "start", {0.5, 1}}, {1, "DRIVE FORWARD", "AVOID TURN", "", {1, 1}}};
  std::vector<std::string> hashes;
  for (const std::string method : {"tangent", "lidar_bug"}) {
    run.method = method;
    drawGoalRun(request, run, "title", folder / (method + ".png"));
    hashes.push_back(resources::fileSha256(folder / (method + ".png")));
  }
  EXPECT_NE(hashes[0], hashes[1]);
}

TEST(BrokenAtCarries, LeavesAGapWhereTheRobotWasCarried) {
  const core::Trajectory truth = {{0, {0, 0, 0}}, {1, {1, 0, 0}}, {2, {9, 0, 0}}, {3, {10, 0, 0}}};
  const auto path = truth::brokenAtCarries(truth, {{1.5, {1.5, 0, 0}, {8.5, 0, 0}}});
  ASSERT_EQ(path.size(), 5U);
  EXPECT_FALSE(core::isFinite(path[2].pose));
  EXPECT_EQ(path[3].pose.x, 9);
  EXPECT_EQ(truth::brokenAtCarries(truth, {}).size(), 4U);
}

}  // namespace
}  // namespace slam::reach
