#include <gmock/gmock.h>

#include <algorithm>

#include "libslam/buildings/building.h"
#include "libslam/core/error.h"
#include "libslam/navigate/driver.h"
#include "libslam/safety/free_ways.h"
#include "libslam/strategies/strategy.h"
#include "tests/navigate/scenes.h"

namespace slam::navigate {
namespace {

using core::degToRad;
using world::Cell;

/// Gives out a list of decisions, then says that it has finished.
class Script : public strategies::Strategy {
 public:
  explicit Script(std::vector<choices::Decision> decisions) : decisions_(std::move(decisions)) {}
  choices::Decision decide(const lidar::Scan&, const core::Pose2&) override {
    choices::Decision decision;
    decision.finished = next_ == decisions_.size();
    return decision.finished ? decision : decisions_[next_++];
  }

 private:
  std::vector<choices::Decision> decisions_;
  size_t next_ = 0;
};

choices::Decision turnAndDrive(double turn_rad, double distance_m) {
  choices::Decision decision;
  decision.turn_rad = turn_rad, decision.distance_m = distance_m;
  return decision;
}

robot::OdometryOptions perfectOdometry() {
  robot::OdometryOptions options;
  options.alpha1 = options.alpha2 = options.alpha3 = options.alpha4 = 0;
  options.scale = 1;
  options.heading_bias_radpm = 0;
  return options;
}

struct Drive {
  core::Pose2 end;
  double time_s = 0;
  size_t collisions = 0;
  bool finished = false;
};

/// Carries out the script in the plan, for at most limit_s; perfect odometry, checks every command's limits.
Drive carryOut(const world::Plan& plan, const core::Pose2& start, std::vector<choices::Decision> decisions,
               double limit_s = 120, const strategies::StrategyOptions& options = {}) {
  const robot::RobotOptions robot;
  sim::Simulator simulator(plan, robot, scenes::circleLidar(), perfectOdometry(), start, 1, 0.0);
  Driver driver(std::make_unique<Script>(std::move(decisions)), options, robot, 0.2, {1, "driver"});
  sim::Sensed sensed = simulator.sense();
  while (!driver.finished() && simulator.time_s() < limit_s) {
    const auto command = driver.next(sensed.scan, sensed.T_odom_robot, sensed.collided);
    EXPECT_EQ(command.duration_s, 0.2);
    EXPECT_LE(std::abs(command.speed_mps), robot.max_speed_mps * (1 + 1e-12));
    EXPECT_LE(std::abs(command.turn_rate_radps), robot.max_turn_rate_radps * (1 + 1e-12));
    sensed = simulator.step(command);
  }
  return {simulator.truth(), simulator.time_s(), simulator.collisions().size(), driver.finished()};
}

TEST(Driver, TurnsAndDrivesAsDecided) {
  const auto drive = carryOut(scenes::room(8, 8), {2, 2, 0.5}, {turnAndDrive(1.0, 2.5)});
  EXPECT_TRUE(drive.finished);
  // The last centimetre is not worth a period, and the smallest turn is 1 mrad.
  EXPECT_NEAR(drive.end.phi, 1.5, 0.001);
  EXPECT_NEAR(drive.end.x, 2 + 2.5 * std::cos(1.5), 0.013);
  EXPECT_NEAR(drive.end.y, 2 + 2.5 * std::sin(1.5), 0.013);
  // One period per 0.1 m and per 12 degrees, one more for the rest of the turn and for finishing.
  EXPECT_NEAR(drive.time_s, 2.5 / 0.5 + 1.0 / degToRad(60) + 0.2, 0.41);
}

TEST(Driver, StopsEarlyBeforeAWallAndDecidesAgain) {
  for (const double clearance_m : {0.45, 1.0}) {
    strategies::StrategyOptions options;
    options.stop_clearance_m = clearance_m;
    const auto drive = carryOut(scenes::room(6, 6), {3, 3, 0},
                                {turnAndDrive(0, 50), turnAndDrive(core::kPi / 2, 0)}, 120, options);
    EXPECT_TRUE(drive.finished);
    EXPECT_EQ(drive.collisions, 0u);
    // The drive may stop up to one period's 0.1 m late, and four standard deviations of a range off.
    const double gap_m = 6 - drive.end.x;
    EXPECT_LT(gap_m, clearance_m + 0.04);
    EXPECT_GT(gap_m, clearance_m - 0.14);
    EXPECT_NEAR(drive.end.phi, core::kPi / 2, 0.001);
  }
}

TEST(Driver, PassesADoorOfNinetyCentimetres) {
  auto plan = scenes::room(6, 4);
  scenes::fill(plan, 3, 0, 3.1, 4);
  scenes::fill(plan, 3, 1.55, 3.1, 2.45, Cell::kFree);
  for (const double off_centre_m : {-0.1, 0.0, 0.1}) {
    const auto drive = carryOut(plan, {1, 2 + off_centre_m, 0}, {turnAndDrive(0, 4)});
    EXPECT_NEAR(drive.end.x, 5, 0.013) << off_centre_m;  // the last centimetre is not worth a period
    EXPECT_EQ(drive.collisions, 0u);
  }
}

TEST(Driver, LeavesAPocketWhereEveryWayIsBlocked) {
  auto plan = scenes::room(6, 4);
  scenes::fill(plan, 0, 0, 1.2, 4);
  scenes::fill(plan, 0.3, 1.6, 1.2, 2.4, Cell::kFree);  // 0.9 m deep, 0.8 m wide
  // Always wants to go to the pocket's end, which CanMove forbids.
  std::vector<choices::Decision> wishes(200, turnAndDrive(core::kPi, 5));
  const auto drive = carryOut(plan, {0.72, 2, 0}, wishes, 60);
  EXPECT_EQ(drive.collisions, 0u);
  EXPECT_GT(drive.end.x, 1.2);
}

TEST(Driver, BacksOffFromWhatTheLidarDoesNotSee) {
  Driver driver(std::make_unique<Script>(std::vector<choices::Decision>(9, turnAndDrive(0, 5))), {}, {}, 0.2,
                {1, "driver"});
  lidar::Scan scan;  // nothing near, all round
  scan.first_angle_rad = -core::kPi;
  scan.step_rad = degToRad(1);
  scan.max_range_m = 10;
  scan.ranges_m.assign(360, 8.0F);
  EXPECT_GT(driver.next(scan, {0, 0, 0}, false).speed_mps, 0);
  EXPECT_LT(driver.next(scan, {0.05, 0, 0}, true).speed_mps, 0);
}

TEST(Driver, StandsStillWhenTheStrategyHasFinished) {
  Driver driver(std::make_unique<Script>(std::vector<choices::Decision>{}), {}, {}, 0.2, {1, "driver"});
  const auto command = driver.next({}, {}, false);
  EXPECT_TRUE(driver.finished());
  EXPECT_EQ(command.speed_mps, 0);
  EXPECT_EQ(command.turn_rate_radps, 0);
  EXPECT_EQ(command.duration_s, 0.2);
}

TEST(Driver, RefusesToWorkWithoutStrategyOrPeriod) {
  EXPECT_THROW(Driver(nullptr, {}, {}, 0.2, {1, "driver"}), core::ContractError);
  EXPECT_THROW(Driver(strategies::makeStrategy({}, {1, "s"}), {}, {}, 0, {1, "driver"}), core::ContractError);
}

TEST(Driver, SurvivesALidarThatLosesEverything) {
  Driver driver(strategies::makeStrategy({}, {1, "s"}), {}, {}, 0.2, {1, "driver"});
  lidar::Scan scan;
  scan.step_rad = degToRad(1);
  scan.ranges_m.assign(360, lidar::kLostReading);
  for (int i = 0; i < 100; ++i) ASSERT_EQ(driver.next(scan, {}, false).speed_mps, 0);  // never blind
}

strategies::StrategyOptions named(const std::string& name) {
  strategies::StrategyOptions options;
  options.name = name;
  return options;
}

TEST(Exploration, TheSameSeedTakesTheSameWay) {
  const auto plan = scenes::flat();
  const auto way = [&](std::uint64_t seed) {
    return scenes::explore(plan, {6, 4, 0}, named("quadrant"), scenes::circleLidar(), seed, 60).truth;
  };
  const auto once = way(1), again = way(1), other = way(2);
  ASSERT_EQ(once.size(), again.size());
  for (size_t i = 0; i < once.size(); ++i) {
    ASSERT_EQ(once[i].x, again[i].x);
    ASSERT_EQ(once[i].phi, again[i].phi);
  }
  EXPECT_GT(core::distance(once.back(), other.back()), 0.01);
}

/// The original document's diagonal problem, in a hall with a bend: legs of 12 m and 6 m, 2 m wide. Wherever
/// the robot stops in the long leg, the longest ray is that leg's own diagonal.
TEST(Exploration, TheLongestRayShuttlesAlongTheDiagonalWhereQuadrantsGoRoundTheBend) {
  auto plan = scenes::room(12, 6);
  scenes::fill(plan, 0, 2, 10, 6);
  for (const std::uint64_t seed : {1, 2, 3}) {
    for (const std::string name : {"longest_ray", "quadrant"}) {
      const auto way =
          scenes::explore(plan, {4, 1, 0.1}, named(name), scenes::circleLidar(), seed, 200).truth;
      const bool round_the_bend =
          std::any_of(way.begin(), way.end(), [](const core::Pose2& pose) { return pose.y > 4; });
      EXPECT_EQ(round_the_bend, name == "quadrant") << name << ", seed " << seed;
      int crossings = 0;  // of the long leg's middle
      for (size_t i = 1; i < way.size(); ++i) crossings += (way[i - 1].x < 6) != (way[i].x < 6);
      EXPECT_GE(crossings, name == "quadrant" ? 1 : 4) << name << ", seed " << seed;
    }
  }
}

TEST(Exploration, NeverCollidesInAnyWorldWithNoiseOn) {
  auto lidar = scenes::circleLidar();
  lidar.beams = 180;  // coarse on purpose: more slips between two beams
  for (const auto& world : buildings::buildingNames()) {
    const auto plan = buildings::makeBuilding(world, 1);
    const auto start = world::findStartPose(plan, 0.35);
    ASSERT_TRUE(start) << world;
    for (const auto& name : scenes::maplessStrategies())
      for (const std::uint64_t seed : {1, 2})
        EXPECT_EQ(scenes::explore(plan, *start, named(name), lidar, seed, 300).collisions, 0u)
            << world << ", " << name << ", seed " << seed;
  }
}

TEST(Exploration, MovesOnWithALidarThatLooksAheadOnlyAndNeverCollides) {
  const auto plan = scenes::flat();
  auto lidar = scenes::circleLidar();
  lidar.fov_rad = core::kPi;
  lidar.beams = 181;
  for (const auto& name : scenes::maplessStrategies()) {
    const auto exploration = scenes::explore(plan, {6, 4, 0}, named(name), lidar, 1, 300);
    double path_m = 0;
    for (size_t i = 1; i < exploration.truth.size(); ++i)
      path_m += core::distance(exploration.truth[i - 1], exploration.truth[i]);
    EXPECT_EQ(exploration.collisions, 0u) << name;
    EXPECT_GT(path_m, 40)
        << name;  // of 150 m at full speed: it cannot back off, and still gets out of corners
  }
}

TEST(Exploration, QuadrantsSeeMostOfAFlatInFiveMinutes) {
  const auto plan = scenes::flat();
  double share = 0;
  for (const std::uint64_t seed : {1, 2, 3})
    share += scenes::explore(plan, {6, 4, 0}, named("quadrant"), scenes::circleLidar(), seed, 300).seen_share;
  EXPECT_GT(share / 3, 0.75);  // measured 0.8 to 0.95; chance plays a large part
}

TEST(Exploration, FollowingTheWallGoesRoundTheRoomAtItsDistance) {
  auto plan = scenes::room(8, 6);
  scenes::fill(plan, 5, 0, 6, 2);  // a corner that stands out into the room
  for (const std::uint64_t seed : {1, 2}) {
    const auto way =
        scenes::explore(plan, {3, 3, 0.3}, named("wall_follow"), scenes::circleLidar(), seed, 150).truth;
    bool south_west = false, north_west = false, north_east = false, south_east = false;
    for (size_t i = 0; i < way.size(); ++i) {
      const double aside = std::min(std::min(way[i].x, 8 - way[i].x), std::min(way[i].y, 6 - way[i].y));
      if (i > 60 && way[i].y > 2.6) {
        EXPECT_LT(aside, 0.9) << seed << ": " << way[i].x << ", " << way[i].y;
      }
      south_west |= way[i].x < 1 && way[i].y < 1;
      north_west |= way[i].x < 1 && way[i].y > 5;
      north_east |= way[i].x > 7 && way[i].y > 5;
      south_east |= way[i].x > 6.5 && way[i].y < 1.2;
    }
    EXPECT_TRUE(south_west && north_west && north_east && south_east) << seed;
  }
}

/// Wants to go along the same path of the map until it has arrived.
class MapScript : public strategies::Strategy {
 public:
  explicit MapScript(std::vector<core::Point2> path) : path_(std::move(path)) {}
  choices::Decision decide(const lidar::Scan&, const core::Pose2&) override {
    choices::Decision decision;
    decision.finished = arrivals > 0;
    decision.path = path_;
    decision.goal = path_.back();
    decision.reason = "as the script says";
    return decision;
  }
  bool needsMap() const override { return true; }
  bool drivesByDisc() const override { return true; }
  bool isStillGood(const choices::Decision&, const core::Pose2&, size_t) override { return true; }
  void tellOutcome(const choices::Decision&, bool reached) override { ++(reached ? arrivals : failures); }
  int arrivals = 0, failures = 0;

 private:
  std::vector<core::Point2> path_;
};

TEST(Driver, AsksForAMapOnlyWhereTheStrategyNeedsOne) {
  const Driver original(strategies::makeStrategy({}, {1, "s"}), {}, {}, 0.2, {1, "driver"});
  EXPECT_FALSE(original.wantsMap());
  for (const auto& name : strategies::strategyNames())
    if (strategies::strategyNeedsMap(name)) {
      Driver driver(strategies::makeStrategy(named(name), {1, "s"}), {}, {}, 0.2, {1, "driver"});
      EXPECT_TRUE(driver.wantsMap()) << name;
      EXPECT_THROW(driver.next({}, {}, false), core::ContractError) << name;
    }
}

struct PathDrive {
  core::Pose2 end;
  int arrivals, failures;
  size_t collisions;
  bool finished;
  std::string reason;
  int escapes;  ///< steps on the way to where the script did not send it
};

/// Follows the path in the plan for limit_s with a map that grows by so many square metres whenever it is
/// asked for.
PathDrive followPath(const world::Plan& plan, const core::Pose2& start, std::vector<core::Point2> path,
                     double limit_s, int growth_m2 = 0) {
  auto strategy = std::make_unique<MapScript>(std::move(path));
  const MapScript& script = *strategy;
  const robot::RobotOptions robot;
  sim::Simulator simulator(plan, robot, scenes::circleLidar(), {}, start, 1, 0.0);
  Driver driver(std::move(strategy), {}, robot, 0.2, {1, "driver"});
  sim::Sensed sensed = simulator.sense();
  gridmap::OccupancyRaster map;
  map.resolution_m = 1;
  int escapes = 0;
  while (!driver.finished() && simulator.time_s() < limit_s) {
    if (driver.wantsMap()) {
      map.rows = 1, map.columns += growth_m2;
      map.occupancy.assign(static_cast<size_t>(map.columns), 0.1F);
      driver.setMap(map);
    }
    const auto command = driver.next(sensed.scan, simulator.truth(), sensed.collided);
    EXPECT_LE(std::abs(command.speed_mps), robot.max_speed_mps * (1 + 1e-12));
    EXPECT_LE(std::abs(command.turn_rate_radps), robot.max_turn_rate_radps * (1 + 1e-12));
    escapes += driver.currentDecision().path.empty();
    sensed = simulator.step(command);
  }
  return {simulator.truth(),
          script.arrivals,
          script.failures,
          simulator.collisions().size(),
          driver.finished(),
          driver.currentDecision().reason,
          escapes};
}

TEST(Driver, FollowsAPathThroughADoorAndRoundACorner) {
  auto plan = scenes::room(6, 4);
  scenes::fill(plan, 3, 0, 3.1, 4);
  scenes::fill(plan, 3, 0.5, 3.1, 1.3,
               Cell::kFree);  // 0.8 m wide: canMove() would not let it pass at a slant
  const auto drive = followPath(plan, {1, 3, 2.0}, {{2.2, 1.0}, {4, 0.9}, {5, 3}}, 40);
  EXPECT_EQ(drive.arrivals, 1);
  EXPECT_EQ(drive.failures, 0);
  EXPECT_EQ(drive.collisions, 0u);
  EXPECT_LT(core::distance(core::position(drive.end), {5, 3}), 0.1);
}

TEST(Driver, StepsAsideForWhatThePathDoesNotKnow) {
  auto plan = scenes::room(6, 4);
  scenes::fill(plan, 3, 1.9, 3.1, 2.0);
  const auto drive = followPath(plan, {1, 2, 0}, {{5, 2}}, 40);
  EXPECT_EQ(drive.arrivals, 1);
  EXPECT_EQ(drive.failures, 0);
  EXPECT_EQ(drive.collisions, 0u);
}

TEST(Driver, IsStuckWhereThePathLeadsThroughAWallAndTheMapDoesNotGrow) {
  auto plan = scenes::room(6, 4);
  scenes::fill(plan, 3, 0, 3.1, 4);
  const auto drive = followPath(plan, {1, 2, 0}, {{5, 2}}, 2000);
  EXPECT_TRUE(drive.finished);
  EXPECT_EQ(drive.arrivals, 0);
  EXPECT_GE(drive.failures, 3);
  EXPECT_EQ(drive.collisions, 0u);
  EXPECT_THAT(drive.reason,
              testing::StartsWith("stuck: 20 decisions in a row showed nothing new; the last: "));
}

// What shows something new is no failure, wherever it led.
TEST(Driver, IsNotStuckWhileTheMapGrows) {
  auto plan = scenes::room(6, 4);
  scenes::fill(plan, 3, 0, 3.1, 4);
  const auto still = followPath(plan, {1, 2, 0}, {{5, 2}}, 150),
             grows = followPath(plan, {1, 2, 0}, {{5, 2}}, 150, 1);
  EXPECT_GT(still.escapes, 0);
  EXPECT_EQ(grows.escapes, 0);
  EXPECT_GT(grows.failures, 5);
  EXPECT_FALSE(grows.finished);
}

}  // namespace
}  // namespace slam::navigate
