#include "libslam/strategies/map_strategy.h"

#include <gmock/gmock.h>

#include <cmath>

#include "libslam/buildings/building.h"
#include "libslam/core/error.h"
#include "tests/navigate/scenes.h"
#include "tests/paths/drawn_map.h"

namespace slam::strategies {
namespace {

std::vector<std::string> mapStrategies() {
  std::vector<std::string> names;
  for (const auto& name : strategyNames())
    if (strategyNeedsMap(name)) names.push_back(name);
  return names;
}

StrategyOptions named(const std::string& name) {
  StrategyOptions options;
  options.name = name;
  return options;
}

/// The geometry is all that a map strategy takes from a scan.
lidar::Scan circleScan() {
  lidar::Scan scan;
  scan.first_angle_rad = -core::kPi;
  scan.step_rad = core::degToRad(1);
  scan.max_range_m = 10;
  scan.ranges_m.assign(360, 3.0F);
  return scan;
}

choices::Decision decideOn(const std::string& name, const gridmap::OccupancyRaster& map,
                           const core::Pose2& pose, const StrategyOptions& options = {}) {
  auto all = options;
  all.name = name;
  const auto strategy = makeStrategy(all, {1, "strategy"});
  strategy->seeMap(map);
  return strategy->decide(circleScan(), pose);
}

// Characters are 0.4 m large. A closet behind the left door, near, and a hall behind the right one, farther.
const std::vector<std::string> kClosetAndHall = {"##################",  //
                                                 "########?????????#",  //
                                                 "########?????????#",  //
                                                 "########?????????#",  //
                                                 "#??#####?????????#",  //
                                                 "#??#####?????????#",  //
                                                 "#..#########..####",  //
                                                 "#................#",  //
                                                 "#................#",  //
                                                 "##################"};
const core::Pose2 kBetween{2.5, 0.8, 0};

TEST(MapStrategies, SayClearlyThatTheyNeedAMap) {
  EXPECT_THAT(mapStrategies(),
              testing::ElementsAre("nearest_frontier", "information_gain", "next_best_view", "tour"));
  for (const auto& name : mapStrategies()) {
    try {
      makeStrategy(named(name), {1, "strategy"})->decide(circleScan(), {});
      FAIL() << name;
    } catch (const core::ContractError& error) {
      EXPECT_EQ(error.what(), "strategy '" + name + "' works on the map: give it one first, seeMap()");
    }
  }
}

TEST(MapStrategies, FinishInAClosedRoomAndSayWhatIsLeft) {
  // A pocket with a frontier of its own behind the wall, which nobody can drive to.
  const auto map =
      paths::enlarged({"##########", "#....#...?", "#....#...?", "#....#...?", "##########"}, 8, 0.05);
  for (const auto& name : mapStrategies()) {
    const auto decision = decideOn(name, map, {1, 1, 0});
    EXPECT_TRUE(decision.finished) << name;
    EXPECT_EQ(decision.reason,
              "explored: no frontier of 0.30 m left in reach; out of reach 1, given up after a look 0");
    EXPECT_TRUE(decision.path.empty());
  }
}

TEST(MapStrategies, GiveAPathThatKeepsItsDistanceAndEndsAtTheGoal) {
  const auto map = paths::enlarged(kClosetAndHall, 8, 0.05);
  const auto space = paths::readFreeSpace(map);
  const auto clearance = paths::squaredClearance(space, paths::kOccupiedCell | paths::kUnknownCell, 20);
  for (const auto& name : mapStrategies()) {
    const auto decision = decideOn(name, map, kBetween);
    ASSERT_FALSE(decision.path.empty()) << name;
    EXPECT_EQ(decision.path.back().x, decision.goal.x);
    EXPECT_TRUE(decision.look_at) << name;
    EXPECT_FALSE(decision.alternatives.empty()) << name;
    core::Point2 from = core::position(kBetween);
    for (const auto& to : decision.path) {
      for (double s = 0; s <= 1; s += 0.02) {
        const core::Point2 p{from.x + s * (to.x - from.x), from.y + s * (to.y - from.y)};
        const auto d = clearance[space.index(space.columnOf(p.x), space.rowOf(p.y))];
        // A cell's diagonal less than the radius and margin: the samples are not the cells' centres.
        EXPECT_GE(std::sqrt(d) * 0.05, 0.333 - 0.071) << name;
      }
      from = to;
    }
  }
}

TEST(NearestFrontier, TakesTheNearOneAndInformationGainTheLargeOne) {
  const auto map = paths::enlarged(kClosetAndHall, 8, 0.05);
  const auto nearest = decideOn("nearest_frontier", map, kBetween);
  EXPECT_LT(nearest.goal.x, 1.6);
  EXPECT_THAT(nearest.reason, testing::StartsWith("nearest of 2 frontiers: "));
  for (const std::string name : {"information_gain", "next_best_view"}) {
    const auto decision = decideOn(name, map, kBetween);
    EXPECT_GT(decision.goal.x, 3.6) << name << ": " << decision.reason;
    EXPECT_GT(decision.score, 0);
  }
}

TEST(InformationGain, TakesTheNearerOfTwoEqualViews) {
  const auto map =
      paths::enlarged({"##########", "?........?", "?........?", "?........?", "##########"}, 8, 0.05);
  for (const std::string name : {"information_gain", "nearest_frontier"}) {
    EXPECT_LT(decideOn(name, map, {1.4, 1.0, 0}).goal.x, 2) << name;
    EXPECT_GT(decideOn(name, map, {2.6, 1.0, 0}).goal.x, 2) << name;
  }
}

TEST(MapStrategies, GiveUpAFrontierThatALookLeavesStanding) {
  const auto map = paths::enlarged({"#######", "?.....#", "?.....#", "?.....#", "#######"}, 8, 0.05);
  for (const auto& name : mapStrategies()) {
    const auto strategy = makeStrategy(named(name), {1, "strategy"});
    int decisions = 0;
    while (decisions < 20) {
      strategy->seeMap(map);  // which never changes
      const auto decision = strategy->decide(circleScan(), {1.4, 1, 0});
      if (decision.finished) break;
      strategy->tellOutcome(decision, true);
      ++decisions;
    }
    EXPECT_GE(decisions, 1) << name;
    EXPECT_LT(decisions, 15) << name;
  }
}

TEST(MapStrategies, TryAGoalThatFailedOnceMoreAndThenGiveItUp) {
  const auto map = paths::enlarged({"#######", "?.....#", "?.....#", "#######"}, 8, 0.05);
  const auto strategy = makeStrategy(named("nearest_frontier"), {1, "strategy"});
  strategy->seeMap(map);
  for (int i = 0; i < 2; ++i) {
    const auto decision = strategy->decide(circleScan(), {1.4, 0.8, 0});
    ASSERT_FALSE(decision.finished) << i;
    strategy->tellOutcome(decision, false);
  }
  EXPECT_TRUE(strategy->decide(circleScan(), {1.4, 0.8, 0}).finished);
}

TEST(MapStrategies, DropAGoalThatHasBeenSeenAndAPathThatIsBlocked) {
  auto map = paths::enlarged({"##########", "#........?", "#........?", "#........?", "##########"}, 8, 0.05);
  const core::Pose2 pose{1, 1, 0};
  const auto strategy = makeStrategy(named("nearest_frontier"), {1, "strategy"});
  strategy->seeMap(map);
  const auto decision = strategy->decide(circleScan(), pose);
  EXPECT_TRUE(strategy->isStillGood(decision, pose, 0));
  strategy->seeMap(
      paths::enlarged({"##########", "#...#....?", "#...#....?", "#...#....?", "##########"}, 8, 0.05));
  EXPECT_FALSE(strategy->isStillGood(decision, pose, 0));  // a wall across the path
  strategy->seeMap(
      paths::enlarged({"##########", "#.........", "#.........", "#.........", "##########"}, 8, 0.05));
  EXPECT_FALSE(strategy->isStillGood(decision, pose, 0));  // nothing unknown where it leads
  strategy->seeMap(map);
  EXPECT_TRUE(strategy->isStillGood(decision, pose, 0));
}

// A wall along the line between two rows of cells: the map flickers between them and shows no wall at all,
// but the lidar measures one.
TEST(MapStrategies, SeeNoFrontierWhereTheLidarMeasuresAWall) {
  const auto map = paths::enlarged({"########", "#......?", "#......?", "#......?", "########"}, 8, 0.05);
  const core::Pose2 pose{1.4, 1.0, 0};
  lidar::Scan scan = circleScan();
  for (size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double c = std::cos(scan.angle(static_cast<int>(i)));
    // The right wall stands at x = 2.8; elsewhere nothing comes back.
    scan.ranges_m[i] = c > 0.7 ? static_cast<float>(1.4 / c) : static_cast<float>(scan.max_range_m);
  }
  for (const auto& name : mapStrategies()) {
    const auto strategy = makeStrategy(named(name), {1, "strategy"});
    strategy->seeMap(map);
    EXPECT_FALSE(strategy->decide(scan, pose).finished) << name;
    strategy->seeScan(scan, pose);
    EXPECT_TRUE(strategy->decide(scan, pose).finished) << name;
  }
}

TEST(MapStrategies, DoNotFinishBeforeTheBareDiscHasNoWayLeft) {
  // Unknown behind a gap that is 3 m away; half a cell of the wall counts on each side.
  const auto withGap = [](int cells) {
    std::vector<std::string> lines(41,
                                   "#" + std::string(80, '.') + "####" + std::string(30, '.') + "????????");
    for (int row = 0; row < 41; ++row)
      if (std::abs(row - 20) <= cells / 2) lines[static_cast<size_t>(row)].replace(81, 4, "....");
    lines.front() = lines.back() = std::string(lines.front().size(), '#');
    return paths::drawnMap(lines, 0.05);
  };
  for (const auto& name : mapStrategies()) {
    EXPECT_FALSE(decideOn(name, withGap(15), {1, 1, 0}).finished) << name;  // with the margin
    EXPECT_FALSE(decideOn(name, withGap(13), {1, 1, 0}).finished) << name;
    const auto closed = decideOn(name, withGap(11), {1, 1, 0});
    EXPECT_TRUE(closed.finished) << name;
    EXPECT_THAT(closed.reason, testing::HasSubstr("out of reach 1, given up after a look 0")) << name;
  }
}

// Characters are 0.5 m: a corridor round a block, which the robot has nearly come round; unknown beyond the
// lower right corner.
const std::vector<std::string> kRound = {"################################################",  //
                                         "#..............................................#",  //
                                         "#..............................................#",  //
                                         "#..............................................#",  //
                                         "#...########################################...#",  //
                                         "#...########################################...#",  //
                                         "#...########################################...#",  //
                                         "#...............................................",  //
                                         "#..............................................?",  //
                                         "#..............................................?",  //
                                         "################################################"};
const core::Pose2 kRoundAt{2.5, 4.5, core::kPi};

/// Round the block from its lower left corner, with a spread that grows.
void driveRound(Strategy& strategy, const gridmap::OccupancyRaster& map) {
  auto scan = circleScan();
  scan.ranges_m.assign(scan.ranges_m.size(), lidar::kLostReading);
  strategy.seeMap(map);
  double spread_m = 0;
  const auto at = [&](double x, double y) {
    scan.time_s += 1;
    strategy.seeSpread(spread_m += 0.003);
    strategy.seeScan(scan, {x, y, 0});
  };
  for (double x = 1; x < 23; x += 0.5) at(x, 1);
  for (double y = 1; y < 4.5; y += 0.5) at(23, y);
  for (double x = 23; x >= kRoundAt.x; x -= 0.5) at(x, 4.5);
}

StrategyOptions goingBack(const std::string& name) {
  auto options = named(name);
  options.revisit = true;
  return options;
}

TEST(MapStrategies, GoBackForALoopWhereThePoseHasBecomeUncertain) {
  const auto map = paths::enlarged(kRound, 10, 0.05);
  for (const auto& name : mapStrategies()) {
    const auto strategy = makeStrategy(goingBack(name), {1, "strategy"});
    driveRound(*strategy, map);
    const auto back = strategy->decide(circleScan(), kRoundAt);
    EXPECT_THAT(back.reason, testing::StartsWith("back for a loop: the pose, sure to 0.")) << name;
    ASSERT_FALSE(back.path.empty()) << name;
    EXPECT_LT(back.goal.x, 5) << name;
    EXPECT_LT(back.goal.y, 2) << name;
    EXPECT_GT(back.certainty_m, 0.15) << name;
    EXPECT_GT(back.spread_m, back.certainty_m) << name;
    ASSERT_EQ(back.alternatives.size(), 1U) << name;  // where it would have driven
    EXPECT_TRUE(strategy->isStillGood(back, kRoundAt, 0)) << name;
    // Once the loop is closed there is no need to drive the rest of the way.
    strategy->seeSpread(0.02);
    EXPECT_FALSE(strategy->isStillGood(back, kRoundAt, 0)) << name;
    const auto next = strategy->decide(circleScan(), kRoundAt);
    EXPECT_EQ(next.certainty_m, 0) << name << ": " << next.reason;
    EXPECT_EQ(next.goal.x, back.alternatives.front().x) << name;
    EXPECT_EQ(next.spread_m, 0.02) << name;
  }
}

TEST(MapStrategies, GoBackOnceForALoopThatNobodyCloses) {
  const auto map = paths::enlarged(kRound, 10, 0.05);
  for (const auto& name : mapStrategies()) {
    const auto strategy = makeStrategy(goingBack(name), {1, "strategy"});
    driveRound(*strategy, map);
    const auto back = strategy->decide(circleScan(), kRoundAt);
    ASSERT_GT(back.certainty_m, 0) << name;
    strategy->tellOutcome(back, true);
    strategy->seeMap(map);
    const auto next = strategy->decide(circleScan(), {back.goal.x, back.goal.y, 0});
    EXPECT_EQ(next.certainty_m, 0) << name << ": " << next.reason;
    EXPECT_FALSE(next.finished) << name;
  }
}

TEST(MapStrategies, DoNotGoBackWithoutRevisitOrWithoutACovariance) {
  const auto map = paths::enlarged(kRound, 10, 0.05);
  for (const auto& name : mapStrategies()) {
    const auto strategy = makeStrategy(named(name), {1, "strategy"});
    driveRound(*strategy, map);
    const auto decision = strategy->decide(circleScan(), kRoundAt);
    EXPECT_EQ(decision.certainty_m, 0) << name;
    EXPECT_GT(decision.goal.x, 20) << name;
    EXPECT_GT(decision.spread_m, 0) << name;
    const auto silent = decideOn(name, map, kRoundAt, goingBack(name));
    EXPECT_TRUE(std::isnan(silent.spread_m)) << name;
    EXPECT_EQ(silent.certainty_m, 0) << name;
  }
}

/// The whole loop with the simulator: noise on the lidar, walls to keep away from, doors to pass.
TEST(MapExploration, SeesTheFlatAndTheMazeWholeWithoutACollision) {
  for (const std::string world : {"flat", "maze"}) {
    const auto plan = buildings::makeBuilding(world, 1);
    const auto start = world::findStartPose(plan, 0.35);
    for (const auto& name : mapStrategies()) {
      const auto run =
          navigate::scenes::exploreOnMap(plan, *start, named(name), navigate::scenes::circleLidar(), 1, 1500);
      EXPECT_TRUE(run.finished) << world << ", " << name;
      EXPECT_THAT(run.end, testing::StartsWith("explored: ")) << world << ", " << name;
      EXPECT_EQ(run.collisions, 0u) << world << ", " << name;
      EXPECT_GE(run.seen_share, 0.99) << world << ", " << name;
    }
  }
}

TEST(MapExploration, TheSameSeedTakesTheSameWay) {
  const auto plan = navigate::scenes::flat();
  for (const auto& name : mapStrategies()) {
    const auto way = [&](std::uint64_t seed) {
      return navigate::scenes::exploreOnMap(plan, {6, 4, 0}, named(name), navigate::scenes::circleLidar(),
                                            seed, 20)
          .truth;
    };
    const auto once = way(1), again = way(1);
    ASSERT_EQ(once.size(), again.size());
    for (size_t i = 0; i < once.size(); ++i) {
      ASSERT_EQ(once[i].x, again[i].x) << name;
      ASSERT_EQ(once[i].phi, again[i].phi) << name;
    }
  }
}

}  // namespace
}  // namespace slam::strategies
