#include "libslam/mrptnav/reactive_navigator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/sim/simulator.h"
#include "libslam/testing/temp_folder.h"
#include "libslam/world/plan.h"

namespace slam::mrptnav {
namespace {

using goals::GoalStatus;
using world::Cell;
using world::Plan;

/// width x height metres of free floor at 0.05 m, walls two cells thick all round.
Plan room(double width_m, double height_m) {
  Plan plan;
  plan.name = "room";
  plan.columns = static_cast<int>(std::lround(width_m / plan.resolution_m)) + 4;
  plan.rows = static_cast<int>(std::lround(height_m / plan.resolution_m)) + 4;
  plan.T_frame_raster = {-2 * plan.resolution_m, -2 * plan.resolution_m, 0};
  plan.cells.assign(static_cast<size_t>(plan.columns) * plan.rows, Cell::kOccupied);
  for (int row = 2; row < plan.rows - 2; ++row)
    for (int column = 2; column < plan.columns - 2; ++column)
      plan.cells[static_cast<size_t>(row) * plan.columns + column] = Cell::kFree;
  return plan;
}

void wall(Plan& plan, double x0, double y0, double x1, double y1) {
  const auto low = world::pointToCells(plan, {x0, y0}), high = world::pointToCells(plan, {x1, y1});
  for (long row = std::lround(low.y); row < std::lround(high.y); ++row)
    for (long column = std::lround(low.x); column < std::lround(high.x); ++column)
      plan.cells[static_cast<size_t>(row) * plan.columns + column] = Cell::kOccupied;
}

struct Drive {
  goals::GoalStep end;
  core::Trajectory truth;
  size_t collisions = 0;
  core::Pose2 T_odom_robot;
};

Drive drive(const Plan& plan, const core::Pose2& start, const core::Point2& p_world_goal, std::uint64_t seed,
            double look_ahead_m = 2, double time_limit_s = 120) {
  ReactiveOptions reactive;
  reactive.look_ahead_m = look_ahead_m;  // MRPT's preparations cost its square
  lidar::LidarOptions lidar;
  lidar.fov_rad = core::degToRad(270);
  lidar.max_range_m = 12;
  goals::NavigateOptions limits;
  limits.time_limit_s = time_limit_s;
  goals::GoalTask task;
  task.p_odom_goal = core::inverse(start) * p_world_goal;
  task.period_s = 1 / lidar.rate_hz;
  sim::Simulator simulator(plan, task.robot, lidar, {}, start, seed);
  const auto navigator = makeReactiveNavigator(reactive, limits, task);
  Drive drive;
  for (sim::Sensed sensed = simulator.sense();; sensed = simulator.step(drive.end.command)) {
    drive.truth.push_back({simulator.time_s(), simulator.truth()});
    drive.T_odom_robot = sensed.T_odom_robot;
    drive.end = navigator->next(sensed.scan, sensed.T_odom_robot, sensed.collided);
    if (drive.end.status != GoalStatus::kMoving) break;
  }
  drive.collisions = simulator.collisions().size();
  return drive;
}

Plan roomWithObstacle() {
  Plan plan = room(8, 6);
  wall(plan, 3.5, 2.2, 4.0, 4.0);
  return plan;
}

class ReactiveNavigator : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!reactiveNavigationAvailable()) GTEST_SKIP() << "built without MRPT's module nav (libmrpt-nav-dev)";
    if (!std::filesystem::exists(ReactiveOptions().config))
      GTEST_SKIP() << ReactiveOptions().config << " (Debian package mrpt-common) is not installed";
  }
};

TEST_F(ReactiveNavigator, DrivesRoundAnObstacleToTheGoalFacingItOrNot) {
  for (const double heading_rad : {0.0, 3.0}) {
    const auto result = drive(roomWithObstacle(), {1.5, 3, heading_rad}, {6.5, 3}, 1);
    EXPECT_EQ(result.end.status, GoalStatus::kReached) << result.end.reason;
    EXPECT_EQ(result.collisions, 0U);
    // 5 m as the crow flies, 5.4 m round the wall's corner; a third more for MRPT's arcs.
    EXPECT_LT(core::pathLength(result.truth), 7.2);
    // Odometry drifts by some centimetres per metre with the default noise, and more while turning.
    EXPECT_LT(core::distance(core::position(result.truth.back().pose), {6.5, 3}), 0.8);
  }
}

TEST_F(ReactiveNavigator, CrossesTheHallOfPillarsWithoutACollision) {
  const Plan plan = world::loadPlan(std::string(RASTERSLAM_SOURCE_DIR) + "/datasets/worlds/pillar_hall.yaml");
  const auto start = world::findStartPose(plan, 0.5);
  ASSERT_TRUE(start);
  for (const core::Point2 goal : {core::Point2{4.58, 13.45}, {19.63, 16.94}}) {
    const auto result = drive(plan, *start, goal, 4, ReactiveOptions().look_ahead_m);
    EXPECT_EQ(result.end.status, GoalStatus::kReached) << result.end.reason;
    EXPECT_EQ(result.collisions, 0U);
    const double straight_m = core::distance(core::position(*start), goal);
    EXPECT_LT(core::pathLength(result.truth), 1.5 * straight_m)
        << straight_m;  // there are pillars in between
  }
}

TEST_F(ReactiveNavigator, GivesTheSameCommandsForTheSameScansAndLeavesNothingBehind) {
  const testing::TempFolder folder;
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  const auto a = drive(roomWithObstacle(), {1.5, 3, 0}, {6.5, 3}, 3);
  const auto b = drive(roomWithObstacle(), {1.5, 3, 0}, {6.5, 3}, 3);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  std::filesystem::current_path(before);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  ASSERT_EQ(a.truth.size(), b.truth.size());
  for (size_t i = 0; i < a.truth.size(); ++i) {
    EXPECT_EQ(a.truth[i].pose.x, b.truth[i].pose.x);
    EXPECT_EQ(a.truth[i].pose.phi, b.truth[i].pose.phi);
  }
}

TEST_F(ReactiveNavigator, GivesUpAtAGoalBehindAWallAndAtTheTimeLimit) {
  Plan plan = room(8, 4);
  wall(plan, 4.0, 0, 4.2, 4.0);
  const auto walled = drive(plan, {1.5, 2, 0}, {6.5, 2}, 1);
  EXPECT_EQ(walled.end.status, GoalStatus::kGaveUp);
  EXPECT_EQ(walled.end.reason, "no nearer to the goal for 30 s");
  EXPECT_EQ(walled.collisions, 0U);
  const auto late = drive(plan, {1.5, 2, 0}, {6.5, 2}, 1, 2, 4.0);
  EXPECT_EQ(late.end.status, GoalStatus::kGaveUp);
  EXPECT_EQ(late.end.reason, "time limit of 4 s of the robot's time");
}

TEST_F(ReactiveNavigator, IsThereAtOnceWhenTheGoalIsTheStart) {
  const auto result = drive(roomWithObstacle(), {1.5, 3, 0}, {1.5, 3}, 1);
  EXPECT_EQ(result.end.status, GoalStatus::kReached);
  EXPECT_EQ(result.truth.size(), 1U);
}

TEST_F(ReactiveNavigator, NamesAConfigurationThatIsMissingOrNotOne) {
  const testing::TempFolder folder;
  const auto errorOf = [](const std::string& config) -> std::string {
    ReactiveOptions options;
    options.config = config;
    try {
      makeReactiveNavigator(options, {}, {});
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_NE(errorOf("/nowhere/nav.ini").find("/nowhere/nav.ini"), std::string::npos);
  const std::string empty = RASTERSLAM_SOURCE_DIR "/configs/lidars/utm30lx.ini";
  EXPECT_EQ(errorOf(empty), empty +
                                ": key 'PTG_COUNT' of section [CReactiveNavigationSystem] is missing, "
                                "expected MRPT's configuration of its reactive navigation");
}

TEST_F(ReactiveNavigator, RefusesATaskWithoutAGoalOrAPeriod) {
  goals::GoalTask task;
  task.p_odom_goal.x = NAN;
  EXPECT_THROW(makeReactiveNavigator({}, {}, task), core::ContractError);
  task = {};
  task.period_s = 0;
  EXPECT_THROW(makeReactiveNavigator({}, {}, task), core::ContractError);
}

}  // namespace
}  // namespace slam::mrptnav
