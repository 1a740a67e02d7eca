#include "libslam/goals/look_first.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libslam/goals/goal_navigator.h"
#include "libslam/navigate/driver.h"
#include "libslam/strategies/strategy.h"
#include "tests/navigate/goal_scenes.h"

namespace slam::navigate {
namespace {

using core::degToRad;

/// A look of 60 degrees from 0.1 m ahead of the robot's centre: `everywhere_m` but at `other` {degrees,
/// range}.
lidar::Scan look(float everywhere_m, const std::vector<std::pair<int, float>>& other = {}) {
  lidar::Scan scan;
  scan.first_angle_rad = degToRad(-30), scan.step_rad = degToRad(1);
  scan.min_range_m = 0.5, scan.max_range_m = 4;
  scan.T_robot_lidar = {0.1, 0, 0};
  scan.ranges_m.assign(61, everywhere_m);
  for (const auto& [degrees, range_m] : other) {
    const int beam = degrees + 30;
    scan.ranges_m[static_cast<size_t>(beam)] = range_m;
  }
  return scan;
}

goals::LookFirst careful() {
  return {robot::RobotOptions(), 0.2, obstacles::LocalObstacleOptions()};
}
const robot::Command kAhead{0.5, 0, 0.2}, kBack{-0.5, 0, 0.2}, kTurn{0, 1, 0.2};

/// Turns and looks as it says, in the open, until it has looked enough for the command. Returns by how much
/// it turned.
double lookAround(goals::LookFirst& robot, core::Pose2& T_odom_robot, const robot::Command& command) {
  double turned_rad = 0;
  for (int i = 0; i < 100; ++i) {
    robot.update(look(lidar::kNoReturn), T_odom_robot);
    auto turn = robot.looking();
    if (!turn) turn = robot.instead(command);
    if (!turn) return turned_rad;
    EXPECT_EQ(turn->speed_mps, 0);
    turned_rad += std::abs(turn->turn_rate_radps * turn->duration_s);
    T_odom_robot = T_odom_robot * robot::driveMotion(*turn, turn->duration_s);
  }
  return std::numeric_limits<double>::infinity();
}

TEST(LookFirst, LooksToBothSidesBeforeTheFirstStepAndThenDrivesOn) {
  auto robot = careful();
  core::Pose2 T_odom_robot;
  robot.update(look(lidar::kNoReturn), T_odom_robot);
  EXPECT_TRUE(robot.leadsOverUnseen(kAhead)) << "beside the narrow view";
  EXPECT_FALSE(robot.leadsOverUnseen(kTurn)) << "the circle is where it was";
  const double turned_rad = lookAround(robot, T_odom_robot, kAhead);
  EXPECT_GT(turned_rad, degToRad(30));
  EXPECT_LT(turned_rad, degToRad(360));
  // Where it looked by then it may go, step after step, without another look.
  for (int i = 0; i < 10; ++i) {
    T_odom_robot = T_odom_robot * robot::driveMotion(kAhead, 0.2);
    robot.update(look(lidar::kNoReturn), T_odom_robot);
    EXPECT_FALSE(robot.instead(kAhead)) << i;
  }
  EXPECT_FALSE(robot.leadsOverUnseen(kBack)) << "it came from there";
}

TEST(LookFirst, TakesWhatHidesTheFloorForAnObstacleUntilItSeesTheFloor) {
  auto robot = careful();
  const auto wall = look(lidar::kLostReading);  // something in the dead zone hides all floor
  robot.update(wall, {});
  core::Pose2 T_odom_robot;
  for (int i = 0; i < 20 && robot.hidden().empty(); ++i) {
    auto turn = robot.looking();
    if (!turn) turn = robot.instead(kAhead);
    ASSERT_TRUE(turn);
    T_odom_robot = T_odom_robot * robot::driveMotion(*turn, turn->duration_s);
    robot.update(wall, T_odom_robot);
  }
  ASSERT_EQ(robot.hidden().size(), 1U);
  const core::Point2 hidden = T_odom_robot * robot.hidden()[0];
  EXPECT_NEAR(std::hypot(hidden.x, hidden.y), 0.3, 0.05) << "right before the robot's circle";
  EXPECT_FALSE(robot.looking());
  robot.update(look(lidar::kNoReturn), {0, 0, std::atan2(hidden.y, hidden.x)});
  EXPECT_TRUE(robot.hidden().empty()) << "it has gone";
}

TEST(LookFirst, KnowsTheFloorBeforeItsMinimumRangeByWhatItShowsBeyond) {
  auto robot = careful();
  robot.update(look(2), {});
  const robot::Command creep{0.02, 0, 0.2};
  core::Pose2 T_odom_robot;
  EXPECT_LT(lookAround(robot, T_odom_robot, creep), degToRad(360)) << "0.3 m ahead is nearer than it sees";
}

struct ByCamera {
  const char *method, *scene;
  goals::GoalStatus end;
};
class CameraNavigation : public testing::TestWithParam<ByCamera> {};
INSTANTIATE_TEST_SUITE_P(Drives, CameraNavigation,
                         testing::Values(ByCamera{"bug1", "pillar", goals::GoalStatus::kReached},
                                         ByCamera{"bug2", "doors", goals::GoalStatus::kReached},
                                         ByCamera{"tangent", "doors", goals::GoalStatus::kReached},
                                         ByCamera{"tangent", "pillars", goals::GoalStatus::kReached},
                                         ByCamera{"lidar_bug", "pillar", goals::GoalStatus::kReached},
                                         ByCamera{"bug2", "start in a box", goals::GoalStatus::kUnreachable}),
                         [](const auto& drive) {
                           std::string name = std::string(drive.param.method) + "_" + drive.param.scene;
                           for (auto& letter : name)
                             if (letter == ' ') letter = '_';
                           return name;
                         });

TEST_P(CameraNavigation, ComesToTheRightEndWithoutACollision) {
  auto all = scenes::reachableScenes();
  for (auto& scene : scenes::unreachableScenes()) all.push_back(std::move(scene));
  goals::NavigateOptions options;  // as record::withCameraDefaults() has them
  options.memory = "local_map", options.unseen = "looked_at", options.time_limit_s = 300;
  for (const auto& [name, scene] : all) {
    if (name != GetParam().scene) continue;
    const auto drive = scenes::driveByCamera(scene, GetParam().method, options);
    EXPECT_EQ(drive.status, GetParam().end) << drive.reason;
    EXPECT_EQ(drive.collisions, 0U);
    if (GetParam().end == goals::GoalStatus::kReached) {
      EXPECT_LT(drive.goal_distance_m, 0.15);
    }
    return;
  }
  FAIL() << "no scene '" << GetParam().scene << "'";
}

TEST(Driver, LooksBeforeItDrivesAndThenDrivesTheWayThatItHadChosen) {
  strategies::StrategyOptions options;
  options.name = "longest_ray", options.unseen = "looked_at";
  Driver driver(strategies::makeStrategy(options, {1, "strategy"}), options, {}, 0.2, {1, "driver"});
  core::Pose2 T_odom_robot;
  double turned_rad = 0;
  for (int i = 0; i < 100; ++i) {
    const auto command = driver.next(look(lidar::kNoReturn), T_odom_robot, false);
    if (command.speed_mps > 0) break;
    turned_rad += std::abs(command.turn_rate_radps * command.duration_s);
    T_odom_robot = T_odom_robot * robot::driveMotion(command);
  }
  EXPECT_GT(turned_rad, degToRad(60)) << "to both sides and back";
  EXPECT_NEAR(T_odom_robot.phi, 0, 1e-9) << "the longest ray was straight ahead";
  EXPECT_GT(driver.next(look(lidar::kNoReturn), T_odom_robot, false).speed_mps, 0);
}

}  // namespace
}  // namespace slam::navigate
