#include "libslam/strategies/strategy.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <set>

#include "libslam/core/error.h"
#include "tests/navigate/scenes.h"

namespace slam::strategies {
namespace {

using core::degToRad;
using core::radToDeg;

/// One beam per degree from -180 to 179; `rays` are {degrees, range}, every other range is 1 m.
lidar::Scan circle(const std::vector<std::pair<int, float>>& rays) {
  lidar::Scan scan;
  scan.first_angle_rad = -core::kPi;
  scan.step_rad = degToRad(1);
  scan.max_range_m = 20;
  scan.ranges_m.assign(360, 1.0F);
  for (const auto& [degrees, range_m] : rays) {
    const int beam = degrees + 180;
    scan.ranges_m[static_cast<size_t>(beam)] = range_m;
  }
  return scan;
}

std::unique_ptr<Strategy> make(const std::string& name, double divisor = 1, std::uint64_t seed = 1) {
  StrategyOptions options;
  options.name = name;
  options.divisor_min = options.divisor_max = divisor;
  return makeStrategy(options, {seed, "strategy"});
}

TEST(Strategies, AreMadeByNameAndSayWhichOnesThereAre) {
  EXPECT_THAT(strategyNames(),
              testing::ElementsAre("longest_ray", "quadrant", "random_heading", "wall_follow",
                                   "nearest_frontier", "information_gain", "next_best_view", "tour"));
  for (const auto& name : strategyNames()) EXPECT_TRUE(make(name)) << name;
  try {
    make("quadrants");
    FAIL();
  } catch (const core::InputError& error) {
    EXPECT_STREQ(error.what(),
                 "section [strategy], key 'name': found 'quadrants', expected a strategy; did you mean "
                 "'quadrant'?");
  }
}

TEST(Strategies, RefuseDivisorsInTheWrongOrder) {
  StrategyOptions options;
  options.divisor_min = 2, options.divisor_max = 0.5;
  try {
    makeStrategy(options, {1, "strategy"});
    FAIL();
  } catch (const core::InputError& error) {
    EXPECT_STREQ(error.what(),
                 "section [strategy], key 'divisor_max': found '0.5', expected at least divisor_min, 2");
  }
}

TEST(Strategies, SayWhatTheyAreFor) {
  for (const auto& name : strategyNames()) EXPECT_GT(strategyMeaning(name).size(), 15u) << name;
  EXPECT_FALSE(strategyNeedsMap("wall_follow"));
  EXPECT_TRUE(strategyNeedsMap("next_best_view"));
  EXPECT_THROW(strategyMeaning("quadrants"), core::ContractError);
  EXPECT_THROW(strategyNeedsMap("quadrants"), core::ContractError);
}

TEST(Strategies, StandStillWithoutAnyReading) {
  for (const auto& name : navigate::scenes::maplessStrategies()) {
    auto scan = circle({});
    std::fill(scan.ranges_m.begin(), scan.ranges_m.end(), lidar::kLostReading);
    const auto decision = make(name)->decide(scan, {});
    EXPECT_EQ(decision.turn_rad, 0);
    EXPECT_EQ(decision.distance_m, 0);
    EXPECT_EQ(decision.reason, "no valid reading");
  }
}

TEST(LongestRay, TurnsToTheLongestRayAndDrivesItsLengthOverU) {
  const auto decision = make("longest_ray", 2)->decide(circle({{42, 7}, {-100, 6}}), {1, 2, 3});
  EXPECT_NEAR(radToDeg(decision.turn_rad), 42, 1e-9);
  EXPECT_DOUBLE_EQ(decision.distance_m, 3.5);
  EXPECT_DOUBLE_EQ(decision.score, 7);
  EXPECT_EQ(decision.reason, "longest ray 7.00 m at 42 deg");
  EXPECT_FALSE(decision.finished);
}

TEST(LongestRay, TurnsTheShorterWayRoundToARayOnTheRight) {
  EXPECT_NEAR(radToDeg(make("longest_ray")->decide(circle({{-100, 6}}), {}).turn_rad), -100, 1e-9);
}

TEST(LongestRay, TakesTheFirstOfEqualRaysCounterClockwiseFromAhead) {
  const auto decision = make("longest_ray")->decide(circle({{-1, 7}, {90, 7}, {150, 7}}), {});
  EXPECT_NEAR(radToDeg(decision.turn_rad), 90, 1e-9);
}

TEST(LongestRay, TakesNoReturnForTheMaximumRange) {
  const auto decision = make("longest_ray")->decide(circle({{10, 19}, {30, lidar::kNoReturn}}), {});
  EXPECT_NEAR(radToDeg(decision.turn_rad), 30, 1e-9);
  EXPECT_EQ(decision.distance_m, 20);
}

TEST(LongestRay, DrivesBetweenHalfTheRayAndTenTimes) {
  StrategyOptions options;
  options.name = "longest_ray";
  auto strategy = makeStrategy(options, {1, "strategy"});
  double nearest = 1e9, farthest = 0;
  for (int i = 0; i < 2000; ++i) {
    const double distance_m = strategy->decide(circle({{0, 4}}), {}).distance_m;
    nearest = std::min(nearest, distance_m), farthest = std::max(farthest, distance_m);
  }
  EXPECT_GE(nearest, 2.0);
  EXPECT_LT(nearest, 2.02);  // 2000 draws come within 1 % of either end, practically always
  EXPECT_LE(farthest, 40.0);
  EXPECT_GT(farthest, 36.0);
}

TEST(Quadrant, TakesTheLongestOfFourCandidatesAndShowsTheOthers) {
  const auto decision =
      make("quadrant")->decide(circle({{10, 4}, {20, 3}, {100, 5}, {-170, 3}, {-60, 2}}), {});
  EXPECT_NEAR(radToDeg(decision.turn_rad), 100, 1e-9);
  EXPECT_EQ(decision.distance_m, 5);
  EXPECT_EQ(decision.reason, "rear-left: longest ray 5.00 m at 100 deg");
  ASSERT_EQ(decision.alternatives.size(), 3u);
  const std::vector<double> lengths = {4, 3, 2};
  for (size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(std::hypot(decision.alternatives[i].x, decision.alternatives[i].y), lengths[i], 1e-6);
}

TEST(Quadrant, DoesNotGoBackTheWayItCame) {
  for (const double heading_deg : {0.0, 75.0, -170.0}) {  // the rule must not depend on the odometry's axes
    auto strategy = make("quadrant");
    const core::Pose2 from{1, 2, degToRad(heading_deg)}, here = from * core::Pose2{3, 0, 0};
    strategy->decide(circle({{0, 9}}), from);
    const auto scan = circle({{-175, 9}, {170, 8}, {20, 3}, {-50, 4}});
    EXPECT_NEAR(radToDeg(strategy->decide(scan, here).turn_rad), -50, 1e-9);
    EXPECT_NEAR(radToDeg(make("longest_ray")->decide(scan, here).turn_rad), -175, 1e-9);
  }
}

TEST(Quadrant, KnowsTheWayBackAfterTurningAndBackingOff) {
  auto strategy = make("quadrant");
  strategy->decide(circle({}), {0, 0, 0});
  strategy->decide(circle({}), {3, 0, 0});
  // Turned to the left and shifted a little since: the way back is now on the left.
  const auto decision = strategy->decide(circle({{85, 9}, {-20, 4}}), {2.8, 0, degToRad(90)});
  EXPECT_NEAR(radToDeg(decision.turn_rad), -20, 1e-9);
}

TEST(Quadrant, GoesBackFromADeadEnd) {
  auto strategy = make("quadrant");
  strategy->decide(circle({}), {0, 0, 0});
  auto scan = circle({});
  std::fill(scan.ranges_m.begin(), scan.ranges_m.end(), 0.4F);
  scan.ranges_m[0] = 3;  // straight back
  const auto decision = strategy->decide(scan, {3, 0, 0});
  EXPECT_NEAR(std::abs(radToDeg(decision.turn_rad)), 180, 1e-9);
  EXPECT_EQ(decision.reason, "rear-right: longest ray 3.00 m at 180 deg, the way back");
}

TEST(Quadrant, WorksWithTheQuadrantsThatTheLidarSees) {
  auto scan = circle({{30, 5}, {-30, 6}, {120, 9}});
  scan.ranges_m = {scan.ranges_m.begin() + 90, scan.ranges_m.begin() + 270};  // -90 to 89 degrees
  scan.first_angle_rad = -core::kPi / 2;
  const auto decision = make("quadrant")->decide(scan, {});
  EXPECT_NEAR(radToDeg(decision.turn_rad), -30, 1e-9);
  EXPECT_EQ(decision.alternatives.size(), 1u);
}

TEST(Quadrant, TurningTheWorldTurnsTheDecision) {
  // Rays off the quadrants' borders, which a turn by 90 degrees maps onto one another.
  const std::vector<std::pair<int, float>> rays = {{30, 5}, {140, 4}, {-100, 3}, {-20, 6}};
  const double turn_deg = radToDeg(make("quadrant")->decide(circle(rays), {}).turn_rad);
  for (const int quarter : {90, 180, 270}) {
    auto turned = rays;
    for (auto& ray : turned) ray.first = (ray.first + quarter + 180 + 360) % 360 - 180;
    const double turned_deg = radToDeg(make("quadrant")->decide(circle(turned), {}).turn_rad);
    EXPECT_NEAR(core::angleDifference(degToRad(turned_deg), degToRad(turn_deg + quarter)), 0, 1e-9);
  }
}

TEST(RandomHeading, TakesAnyFreeDirectionAndNoBlockedOne) {
  StrategyOptions options;
  options.name = "random_heading";
  options.stop_clearance_m = 1.5;
  const auto strategy = makeStrategy(options, {1, "strategy"});
  std::set<int> directions;
  for (int i = 0; i < 200; ++i)
    directions.insert(static_cast<int>(
        std::lround(radToDeg(strategy->decide(circle({{-170, 3}, {5, 2}, {90, 4}}), {}).turn_rad))));
  EXPECT_THAT(directions, testing::ElementsAre(-170, 5, 90));
}

TEST(RandomHeading, TurnsRoundByAQuarterAtLeastWhereNothingIsFree) {
  StrategyOptions options;
  options.name = "random_heading";
  options.stop_clearance_m = 1.5;
  const auto strategy = makeStrategy(options, {1, "strategy"});
  for (int i = 0; i < 20; ++i) {
    const auto decision = strategy->decide(circle({}), {});
    EXPECT_GE(std::abs(decision.turn_rad), core::kPi / 2);
    EXPECT_EQ(decision.distance_m, 0);
  }
}

TEST(WallFollow, DrivesToTheNearestThingFirst) {
  auto scan = circle({});
  std::fill(scan.ranges_m.begin(), scan.ranges_m.end(), 6.0F);
  scan.ranges_m[180 + 40] = 2.5F;
  const auto decision = make("wall_follow")->decide(scan, {});
  EXPECT_NEAR(radToDeg(decision.turn_rad), 40, 1e-6);
  EXPECT_NEAR(decision.distance_m, 2.0, 1e-6);  // and stops half a metre before it
  EXPECT_EQ(decision.reason, "no wall yet: towards the nearest thing, 2.50 m away");
}

}  // namespace
}  // namespace slam::strategies
