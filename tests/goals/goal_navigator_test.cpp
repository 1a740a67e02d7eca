#include "libslam/goals/goal_navigator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "libslam/buildings/building.h"
#include "libslam/core/error.h"
#include "tests/navigate/goal_scenes.h"
#include "tests/navigate/scenes.h"

namespace slam::navigate {
namespace {

using namespace scenes;

// ---- the contract, for every method

class EveryNavigator : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Methods, EveryNavigator, ::testing::ValuesIn(goals::goalNavigatorNames()),
                         [](const auto& method) { return method.param; });

lidar::Scan emptyScan(float range_m) {
  lidar::Scan scan;
  scan.first_angle_rad = -core::kPi;
  scan.step_rad = core::kPi / 180;
  scan.max_range_m = 6;
  scan.ranges_m.assign(360, range_m);
  return scan;
}

std::unique_ptr<goals::GoalNavigator> navigatorTo(const std::string& method, const core::Point2& goal,
                                                  double limit_s = 100) {
  goals::NavigateOptions options;
  options.time_limit_s = limit_s;
  return goals::makeGoalNavigator(method, options, {goal, robot::RobotOptions(), 0.2});
}

TEST_P(EveryNavigator, CrossesAnOpenRoom) {
  const auto drive = driveTo(openRoom(), GetParam(), exactLidar(), exactOdometry());
  EXPECT_EQ(drive.status, goals::GoalStatus::kReached) << drive.reason;
  EXPECT_LE(drive.goal_distance_m, 0.1 + 1e-9);
  EXPECT_LE(drive.path_m, 4.1);  // 4.01 m as the crow flies, 0.1 m for the turn on the way
  EXPECT_EQ(drive.collisions, 0U);
}

TEST_P(EveryNavigator, IsThereAtOnceWhenTheGoalIsTheStart) {
  const auto step = navigatorTo(GetParam(), {0, 0})->next(emptyScan(3), {}, false);
  EXPECT_EQ(step.status, goals::GoalStatus::kReached);
  EXPECT_EQ(step.command.speed_mps, 0);
  EXPECT_EQ(step.command.turn_rate_radps, 0);
}

TEST_P(EveryNavigator, DrivesWhereNothingReturns) {
  const auto navigator = navigatorTo(GetParam(), {3, -2});
  core::Pose2 T_odom_robot;
  goals::GoalStep step;
  for (int i = 0; i < 200 && step.status == goals::GoalStatus::kMoving; ++i) {
    step = navigator->next(emptyScan(lidar::kNoReturn), T_odom_robot, false);
    T_odom_robot = T_odom_robot * robot::driveMotion(step.command);
  }
  EXPECT_EQ(step.status, goals::GoalStatus::kReached);
}

TEST_P(EveryNavigator, GivesUpWithoutAnyValidReading) {
  const auto navigator = navigatorTo(GetParam(), {3, 0});
  goals::GoalStep step;
  for (int i = 0; i < 30; ++i) {
    step = navigator->next(emptyScan(lidar::kLostReading), {}, false);
    EXPECT_EQ(step.command.speed_mps, 0);
  }
  EXPECT_EQ(step.status, goals::GoalStatus::kGaveUp);
  EXPECT_EQ(step.reason, "no valid reading for 5 s");
}

TEST_P(EveryNavigator, GivesUpAtTheTimeLimitAndWhenThePoseIsLost) {
  const auto navigator = navigatorTo(GetParam(), {100, 0}, 2);
  goals::GoalStep step;
  for (int i = 0; i < 12; ++i) step = navigator->next(emptyScan(lidar::kNoReturn), {0.5 * i, 0, 0}, false);
  EXPECT_EQ(step.status, goals::GoalStatus::kGaveUp);
  EXPECT_EQ(step.reason, "time limit of 2 s of the robot's time");
  const core::Pose2 lost{std::nan(""), 0, 0};
  EXPECT_EQ(navigatorTo(GetParam(), {1, 0})->next(emptyScan(3), lost, false).status,
            goals::GoalStatus::kGaveUp);
}

TEST_P(EveryNavigator, EndsWhenItIsBoxedIn) {
  // Something all round nearer than the guard lets it move.
  const auto navigator = navigatorTo(GetParam(), {3, 0});
  goals::GoalStep step;
  core::Pose2 T_odom_robot;
  for (int i = 0; i < 400 && step.status == goals::GoalStatus::kMoving; ++i) {
    step = navigator->next(emptyScan(0.3F), T_odom_robot, false);
    T_odom_robot = T_odom_robot * robot::driveMotion(step.command);
  }
  EXPECT_NE(step.status, goals::GoalStatus::kMoving);
  EXPECT_NE(step.status, goals::GoalStatus::kReached);
  EXPECT_LT(std::hypot(T_odom_robot.x, T_odom_robot.y), 0.03);
}

TEST_P(EveryNavigator, RepeatsItself) {
  const auto first = driveTo(doors(), GetParam(), circleLidar(), {}, {}, 5);
  const auto second = driveTo(doors(), GetParam(), circleLidar(), {}, {}, 5);
  ASSERT_EQ(first.truth.size(), second.truth.size());
  EXPECT_EQ(first.end.x, second.end.x);
  EXPECT_EQ(first.end.y, second.end.y);
}

// The lidar of 270 degrees with its noise, wheels with theirs, every committed world.
TEST_P(EveryNavigator, NeverCollidesInACommittedWorldWithNoise) {
  for (const auto& name : buildings::buildingNames()) {
    GoalScene scene;
    scene.plan = buildings::makeBuilding(name, 1);
    const auto start = world::findStartPose(scene.plan, robot::circumscribedRadius(robot::RobotOptions()));
    ASSERT_TRUE(start.has_value());
    scene.start = *start;
    lidar::LidarOptions lidar;
    lidar.beams = 181;
    goals::NavigateOptions options;
    options.time_limit_s = 80;
    for (const double side : {-1.0, 1.0}) {
      scene.goal = {start->x + side * 6, start->y + side * 2.5};
      const auto drive = driveTo(scene, GetParam(), lidar, robot::OdometryOptions(), options, 3);
      EXPECT_EQ(drive.collisions, 0U) << name;
      EXPECT_NE(drive.status, goals::GoalStatus::kMoving);
    }
  }
}

TEST_P(EveryNavigator, FeelsItsWayWhereTheLidarSeesNothing) {
  // The plan's edge stops the robot and returns no ray: only the bumper knows of it.
  GoalScene scene{room(4, 3), {1, 1.5, 0}, {8, 1.5}};
  for (auto& cell : scene.plan.cells) cell = world::Cell::kFree;
  fill(scene.plan, 0, 0, 0.1, 0.1);  // a plan needs a wall somewhere
  goals::NavigateOptions options;
  options.time_limit_s = 300;
  const auto drive = driveTo(scene, GetParam(), exactLidar(), exactOdometry(), options);
  EXPECT_NE(drive.status, goals::GoalStatus::kReached);
  EXPECT_GT(drive.collisions, 0U);
}

// ---- the guarantees of the textbook methods

class TextbookBug : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Methods, TextbookBug, ::testing::Values("bug1", "bug2", "tangent"),
                         [](const auto& method) { return method.param; });

TEST_P(TextbookBug, ReachesEveryGoalThatCanBeReached) {
  for (const auto& [name, scene] : reachableScenes())
    for (const bool noisy : {false, true}) {
      // With noise: the lidar with a blind sector behind.
      lidar::LidarOptions lidar = exactLidar();
      if (noisy) lidar = lidar::LidarOptions(), lidar.beams = 271;
      const auto drive = driveTo(scene, GetParam(), lidar, exactOdometry());
      EXPECT_EQ(drive.status, goals::GoalStatus::kReached) << name << ": " << drive.reason;
      EXPECT_LE(drive.goal_distance_m, 0.1 + 1e-9) << name;
      EXPECT_EQ(drive.collisions, 0U) << name;
    }
}

TEST_P(TextbookBug, SaysOfEveryOtherGoalThatItCannotBeReached) {
  for (const auto& [name, scene] : unreachableScenes())
    for (const bool noisy : {false, true}) {
      lidar::LidarOptions lidar = exactLidar();
      if (noisy) lidar = lidar::LidarOptions(), lidar.beams = 271;
      const auto drive = driveTo(scene, GetParam(), lidar, exactOdometry());
      EXPECT_EQ(drive.status, goals::GoalStatus::kUnreachable) << name << ": " << drive.reason;
      EXPECT_EQ(drive.collisions, 0U) << name;
    }
}

TEST_P(TextbookBug, TurnsTheOtherWayWhenAsked) {
  goals::NavigateOptions options;
  options.turn = "right";
  for (const auto& scene : {pillar(), trap()}) {
    const auto drive = driveTo(scene, GetParam(), exactLidar(), exactOdometry(), options);
    EXPECT_EQ(drive.status, goals::GoalStatus::kReached) << drive.reason;
  }
}

GoalScene mazeScene(std::uint64_t seed) {
  GoalScene scene;
  scene.plan = buildings::makeBuilding("maze", seed);
  int low = scene.plan.columns, high = 0;
  for (int row = 0; row < scene.plan.rows; ++row)
    for (int column = 0; column < scene.plan.columns; ++column)
      if (scene.plan.at(column, row) == world::Cell::kFree)
        low = std::min(low, column), high = std::max(high, column);
  // The middles of the first and of the last cell of the maze: passages are 26 cells wide.
  const auto start = world::cellsToPoint(scene.plan, {low + 13.0, low + 13.0});
  scene.start = {start.x, start.y, 0};
  scene.goal = world::cellsToPoint(scene.plan, {high - 12.0, high - 12.0});
  return scene;
}

TEST_P(TextbookBug, FindsThroughGeneratedMazes) {
  for (const std::uint64_t seed : {1, 3}) {
    lidar::LidarOptions lidar = exactLidar(4);
    lidar.beams = 240;
    const auto drive = driveTo(mazeScene(seed), GetParam(), lidar, exactOdometry());
    EXPECT_EQ(drive.status, goals::GoalStatus::kReached) << seed << ": " << drive.reason;
    EXPECT_EQ(drive.collisions, 0U) << seed;
  }
}

TEST_P(TextbookBug, KnowsThatAWalledInGoalOfAMazeCannotBeReached) {
  GoalScene scene = mazeScene(1);
  const auto wall = [&](double x0, double y0, double x1, double y1) {
    fill(scene.plan, scene.goal.x + x0, scene.goal.y + y0, scene.goal.x + x1, scene.goal.y + y1);
  };
  wall(-0.7, -0.7, -0.6, 0.7), wall(-0.7, -0.7, 0.7, -0.6);
  wall(0.6, -0.7, 0.7, 0.7), wall(-0.7, 0.6, 0.7, 0.7);
  lidar::LidarOptions lidar = exactLidar(4);
  lidar.beams = 240;
  const auto drive = driveTo(scene, GetParam(), lidar, exactOdometry());
  EXPECT_EQ(drive.status, goals::GoalStatus::kUnreachable) << drive.reason;
}

TEST(TangentBug, SeesItsWayRoundAPillarWithoutTouchingIt) {
  const auto drive = driveTo(pillar(), "tangent", exactLidar(), exactOdometry());
  // Over the nearer corner the disc's way is 5.22 m.
  EXPECT_LE(drive.path_m, 5.5);
  EXPECT_THAT(drive.states, ::testing::ElementsAre("to goal", "reached"));
}

TEST(TangentBug, SavesWayWithALongerRange) {
  goals::NavigateOptions near;
  near.sensor_range_m = 1.0;
  const auto blind = driveTo(pillar(), "tangent", exactLidar(8), exactOdometry(), near);
  const auto far = driveTo(pillar(), "tangent", exactLidar(8), exactOdometry());
  EXPECT_EQ(blind.status, goals::GoalStatus::kReached) << blind.reason;
  EXPECT_LT(far.path_m, blind.path_m - 0.1);
}

TEST(GoalNavigators, AreMadeByName) {
  try {
    goals::makeGoalNavigator("bug3", {}, {});
    FAIL() << "no error";
  } catch (const core::InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "method of navigation: found 'bug3', expected one of bug1, bug2, tangent, lidar_bug; did you "
        "mean 'bug1'?");
  }
  EXPECT_THROW(goals::makeGoalNavigator("bug1", {}, {{std::nan(""), 0}, {}, 0.2}), core::ContractError);
  EXPECT_THROW(goals::makeGoalNavigator("bug1", {}, {{1, 0}, {}, 0.0}), core::ContractError);
  for (const auto& name : goals::goalNavigatorNames()) EXPECT_NE(goals::goalNavigatorMeaning(name), "");
  EXPECT_THROW(goals::goalNavigatorMeaning("bug3"), core::ContractError);
}

}  // namespace
}  // namespace slam::navigate
