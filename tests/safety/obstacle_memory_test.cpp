#include "libslam/safety/obstacle_memory.h"
#include "libslam/navigate/driver.h"
#include "libslam/safety/free_ways.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "libslam/core/error.h"
#include "libslam/goals/surroundings.h"
#include "libslam/safety/safe_motion.h"
#include "tests/navigate/goal_scenes.h"
#include "tests/navigate/scenes.h"

namespace slam::safety {
namespace {

using core::degToRad;

/// Beams a degree apart over `fov_deg` around the heading; `ranges` are {degrees, range}, nothing elsewhere.
lidar::Scan sector(int fov_deg, const std::vector<std::pair<int, float>>& ranges) {
  lidar::Scan scan;
  scan.first_angle_rad = degToRad(-0.5 * fov_deg);
  scan.step_rad = degToRad(1);
  scan.max_range_m = 8;
  scan.ranges_m.assign(static_cast<size_t>(fov_deg) + 1, lidar::kNoReturn);
  for (const auto& [degrees, range_m] : ranges) {
    const int beam = degrees + fov_deg / 2;
    scan.ranges_m[static_cast<size_t>(beam)] = range_m;
  }
  return scan;
}

class EveryMemory : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Memories, EveryMemory, testing::ValuesIn(safety::obstacleMemoryNames()));

TEST_P(EveryMemory, HasNothingOfTheNewestScanItself) {
  const auto memory = safety::makeObstacleMemory(GetParam(), {});
  EXPECT_TRUE(memory->points().empty());
  memory->update(sector(60, {{0, 1}, {20, 1}}), {});
  EXPECT_TRUE(memory->points().empty());
  memory->update(sector(60, {{0, 1}, {20, 1}}), {});
  EXPECT_TRUE(memory->points().empty()) << "it is seen again";
}

TEST_P(EveryMemory, KeepsWhatTheRobotTurnsAwayFromUnlessItKeepsNothing) {
  const auto memory = safety::makeObstacleMemory(GetParam(), {});
  memory->update(sector(60, {{0, 1}}), {2, 3, 0});
  memory->update(sector(60, {}), {2, 3, core::kPi / 2});
  const auto points = memory->points();
  if (GetParam() == "none") {
    EXPECT_TRUE(points.empty());
    return;
  }
  ASSERT_EQ(points.size(), 1U);
  EXPECT_NEAR(points[0].x, 0, 1e-6);
  EXPECT_NEAR(points[0].y, -1, 1e-6);
  // It looks there again and sees nothing: gone.
  memory->update(sector(60, {}), {2, 3, 0});
  EXPECT_TRUE(memory->points().empty());
}

TEST_P(EveryMemory, DrivesThePillarSceneWithANarrowViewAndADeadZone) {
  goals::NavigateOptions options;
  options.memory = GetParam();
  auto lidar = navigate::scenes::exactLidar();
  lidar.fov_rad = degToRad(90), lidar.beams = 91;
  const auto drive = navigate::scenes::driveTo(navigate::scenes::pillar(), "tangent", lidar,
                                               navigate::scenes::exactOdometry(), options);
  if (GetParam() == "none") return;  // forgets what it drives past; nothing is promised
  EXPECT_EQ(drive.status, goals::GoalStatus::kReached) << drive.reason;
  EXPECT_EQ(drive.collisions, 0U);
}

TEST(ObstacleMemory, OfTheLocalMapKeepsWhatAnObstacleHidesWhereTheShortOneForgetsIt) {
  const auto remembered = [](const std::string& name) {
    const auto memory = safety::makeObstacleMemory(name, {});
    memory->update(sector(60, {{0, 1.2F}}), {});
    memory->update(sector(60, {{0, 0.5F}}), {});  // somebody stands before it
    return memory->points().size();
  };
  EXPECT_EQ(remembered("local_map"), 1U);
  EXPECT_EQ(remembered("short"), 0U);
}

TEST(ObstacleMemory, OfTheLocalMapIsItsZone) {
  obstacles::LocalObstacleOptions zone;
  zone.width_m = 3, zone.front_m = 4, zone.rear_m = 0.5;
  const auto memory = safety::makeObstacleMemory("local_map", zone);
  memory->update(sector(60, {{0, 3.9F}, {30, 3.5F}}), {});  // (3.03, 1.75): outside the zone's width
  memory->update(sector(60, {}), {0, 0, -core::kPi / 2});  // what was ahead is 3.9 m to the left: outside too
  EXPECT_TRUE(memory->points().empty());
  memory->update(sector(60, {{0, 1.4F}}), {});
  memory->update(sector(60, {}), {0, 0, -core::kPi / 2});
  EXPECT_EQ(memory->points().size(), 1U);
  memory->update(sector(60, {}), {0, 0, core::kPi});
  EXPECT_TRUE(memory->points().empty()) << "1.4 m behind, where the zone reaches 0.5 m";
}

TEST(ObstacleMemory, OfTheLocalMapHasRoomForALidarWithMoreBeamsThanPoints) {
  obstacles::LocalObstacleOptions zone;
  zone.max_points = 50;
  const auto memory = safety::makeObstacleMemory("local_map", zone);
  std::vector<std::pair<int, float>> wall;
  for (int degrees = -90; degrees <= 90; ++degrees) wall.push_back({degrees, 0.3F});
  memory->update(sector(180, wall), {});
  memory->update(sector(180, {}), {0, 0, core::kPi});
  EXPECT_GE(memory->points().size(), 10U) << "0.94 m of wall, a point per cell of 5 cm";
  EXPECT_LE(memory->points().size(), 50U);
}

TEST(ObstacleMemory, RefusesAnUnknownName) {
  EXPECT_THROW(safety::makeObstacleMemory("long", {}), core::ContractError);
}

TEST(SafeMotion, CountsWhatIsRememberedLikeWhatIsSeen) {
  const robot::RobotOptions robot;
  const auto empty = sector(360, {});
  const std::vector<core::Point2> ahead = {{1, 0}}, behind = {{-0.4, 0}};
  EXPECT_EQ(safety::discReach(empty, 0, robot), INFINITY);
  EXPECT_NEAR(safety::discReach(empty, 0, robot, ahead), 1 - 0.2 * std::sqrt(2) - 0.02, 1e-12);
  EXPECT_EQ(safety::canMove(empty, 0.5, behind), safety::FreeWays::kFrontOnly);
  EXPECT_EQ(safety::canMove(empty, 0.3, behind), safety::FreeWays::kBoth);
  EXPECT_LT(safety::safeSpeed(empty, robot, 0.2, behind), safety::safeSpeed(empty, robot, 0.2));
}

/// Wants straight ahead for ever.
class Ahead : public strategies::Strategy {
 public:
  choices::Decision decide(const lidar::Scan& /*scan*/, const core::Pose2& /*T_odom_robot*/) override {
    choices::Decision decision;
    decision.distance_m = decision.ray_m = 6;
    decision.reason = "ahead";
    return decision;
  }
};

TEST(Driver, StopsForWhatItRemembersOnlyWhereItRemembers) {
  for (const std::string name : {"none", "local_map"}) {
    strategies::StrategyOptions options;
    options.memory = name;
    options.stop_clearance_m = 0.3;
    navigate::Driver driver(std::make_unique<Ahead>(), options, {}, 0.2, {1, "driver"});
    // 60 degrees of view: something at 25 degrees, 0.45 m away; the robot turns until it has left the view.
    const core::Point2 p_odom{0.45 * std::cos(degToRad(25)), 0.45 * std::sin(degToRad(25))};
    driver.next(sector(60, {{25, 0.45F}}), {}, false);
    core::Pose2 T_odom_robot{0, 0, degToRad(-10)};
    double nearest_m = 1;
    for (int i = 0; i < 10; ++i) {
      T_odom_robot = T_odom_robot * robot::driveMotion(driver.next(sector(60, {}), T_odom_robot, false));
      nearest_m = std::min(nearest_m, core::distance(core::position(T_odom_robot), p_odom));
    }
    // The disc and its margin of 2 cm need 0.303 m.
    if (name == "none") {
      EXPECT_LT(nearest_m, 0.28);
    } else {
      EXPECT_GT(nearest_m, 0.302);
    }
  }
}

TEST(RayNavigator, DrivesRoundWhatStandsInTheWayOfTheRay) {
  // A ray passes close by a pillar where the disc does not: straight on stops before it.
  auto plan = navigate::scenes::room(9, 4);
  navigate::scenes::fill(plan, 3, 0.9, 3.4, 1.9);
  const auto farthest = [&](const std::string& navigator) {
    strategies::StrategyOptions options;
    options.ray_navigator = navigator;
    const robot::RobotOptions robot;
    sim::Simulator simulator(plan, robot, navigate::scenes::exactLidar(12), navigate::scenes::exactOdometry(),
                             {1, 2, 0}, 1);
    navigate::Driver driver(std::make_unique<Ahead>(), options, robot, 0.2, {1, "driver"});
    double farthest_m = 0;
    auto sensed = simulator.sense();
    for (int i = 0; i < 100; ++i) {
      sensed = simulator.step(driver.next(sensed.scan, sensed.T_odom_robot, sensed.collided));
      farthest_m = std::max(farthest_m, simulator.truth().x);
    }
    EXPECT_EQ(simulator.collisions().size(), 0U) << navigator;
    return farthest_m;
  };
  EXPECT_LT(farthest("none"), 3);
  for (const std::string name : {"tangent", "bug2"}) EXPECT_GT(farthest(name), 6) << name;
}

TEST(RayNavigator, LetsTheOriginalStrategiesSeeTheFlatWithoutACollision) {
  for (const std::string name : {"longest_ray", "quadrant"}) {
    strategies::StrategyOptions options;
    options.name = name;
    options.ray_navigator = "tangent";
    const auto run = navigate::scenes::explore(navigate::scenes::flat(), {6, 4, 0}, options,
                                               navigate::scenes::circleLidar(), 3, 300);
    EXPECT_EQ(run.collisions, 0U);
    EXPECT_GT(run.seen_share, 0.5);
  }
}

}  // namespace
}  // namespace slam::safety
