#include <gtest/gtest.h>

#include "libslam/choices/team_share.h"
#include "libslam/navigate/right_of_way.h"
#include "libslam/strategies/map_strategy.h"

namespace slam::navigate {
namespace {

/// Free floor of 20 x 2 m in which only the middle 8 m are known.
gridmap::OccupancyRaster corridor() {
  gridmap::OccupancyRaster map;
  map.columns = 400, map.rows = 40, map.resolution_m = 0.05;
  map.x_min_m = -10, map.y_min_m = -1;
  map.occupancy.assign(size_t{400} * 40, 0.5F);
  for (int row = 0; row < 40; ++row)
    for (int column = 120; column < 280; ++column)
      map.occupancy[static_cast<size_t>(row) * 400 + column] = row < 2 || row >= 38 ? 0.99F : 0.01F;
  return map;
}

lidar::Scan emptyScan() {
  lidar::Scan scan;
  scan.first_angle_rad = -core::kPi;
  scan.step_rad = core::kPi / 90;
  scan.max_range_m = 8;
  scan.ranges_m.assign(180, lidar::kNoReturn);
  return scan;
}

TEST(TeamShare, WhatOneAimsAtTheOtherLeaves) {
  strategies::StrategyOptions options;
  options.name = "nearest_frontier";
  // 1 m to the right of the middle: the right end is nearer.
  const core::Pose2 T_map_robot{1, 0, 0};
  const auto decide = [&](const std::vector<choices::Teammate>& team) {
    const auto strategy = strategies::makeStrategy(options, core::RandomStream(1, "strategy"));
    strategy->seeMap(corridor());
    strategy->seeTeam(team);
    return strategy->decide(emptyScan(), T_map_robot);
  };
  EXPECT_GT(decide({}).goal.x, 3);
  choices::Teammate right;
  right.p_map = {2.5, 0};
  right.goal = core::Point2{3.6, 0};
  EXPECT_LT(decide({right}).goal.x, -3);
  // Nobody aims at anything: the one who is nearer to the right end takes it.
  right.goal.reset();
  EXPECT_LT(decide({right}).goal.x, -3);
  // Both ends are taken: it comes after, short of the goal.
  right.goal = core::Point2{3.6, 0};
  choices::Teammate left = right;
  left.p_map = {-3, 0};
  left.goal = core::Point2{-3.6, 0};
  const auto late = decide({right, left});
  EXPECT_TRUE(late.comes_after || late.wait_s > 0) << late.reason;
  EXPECT_FALSE(late.finished);
}

TEST(TeamShare, WhoHasNothingLeftWaitsForThoseOnTheirWay) {
  strategies::StrategyOptions options;
  options.name = "nearest_frontier";
  auto map = corridor();
  for (auto& p : map.occupancy)
    if (p == 0.5F) p = 0.99F;
  const auto decide = [&](const std::vector<choices::Teammate>& team) {
    const auto strategy = strategies::makeStrategy(options, core::RandomStream(1, "strategy"));
    strategy->seeMap(map);
    strategy->seeTeam(team);
    return strategy->decide(emptyScan(), {0, 0, 0});
  };
  EXPECT_TRUE(decide({}).finished);
  choices::Teammate busy;
  busy.p_map = {2, 0};
  busy.goal = core::Point2{3, 0};
  EXPECT_GT(decide({busy}).wait_s, 0);
  busy.is_heard = false;
  EXPECT_TRUE(decide({busy}).finished);
}

class TwoRobots : public ::testing::Test {
 protected:
  static constexpr double kPeriod_s = 0.2;
  robot::RobotOptions robot_;
  RightOfWay first_{robot_, kPeriod_s, 0, 2}, second_{robot_, kPeriod_s, 1, 2};
  static std::vector<NeighbourRobot> at(int number, double x) { return {{number, {x, 0}, true, {}}}; }
  robot::Command ahead() const { return {robot_.max_speed_mps, 0, kPeriod_s}; }
};

TEST_F(TwoRobots, StopBeforeTheyTouchHoweverBothDrive) {
  core::Pose2 a{-2, 0, 0}, b{2, 0, core::kPi};
  for (int i = 0; i < 60; ++i) {
    const auto map = [] { return gridmap::OccupancyRaster{}; };
    const auto of_a = first_.next(ahead(), emptyScan(), a, at(1, b.x), map);
    const auto of_b = second_.next(ahead(), emptyScan(), b, at(0, a.x), map);
    a = a * robot::driveMotion(of_a.command);
    b = b * robot::driveMotion(of_b.command);
    ASSERT_GT(core::distance(a, b), 2 * robot::circumscribedRadius(robot_));
    if (i > 30) break;
  }
  EXPECT_LT(core::distance(a, b), 1.0);
}

TEST_F(TwoRobots, TheSecondDrivesOutOfTheWayAndComesBack) {
  const auto map = [] {
    auto wide = corridor();  // with a room of 3 m below the corridor
    wide.rows = 140, wide.y_min_m = -6;
    wide.occupancy.assign(size_t{400} * 140, 0.01F);
    return wide;
  };
  core::Pose2 b{0.75, 0, core::kPi};
  int periods = 0;
  while (!second_.givesWay() && periods < 20) {
    second_.next(ahead(), emptyScan(), b, at(0, 0), map);
    ++periods;
  }
  ASSERT_TRUE(second_.givesWay());
  EXPECT_NEAR(periods * kPeriod_s, 1.0, 0.21);  // its patience
  bool is_over = false;
  for (int i = 0; i < 200 && !is_over; ++i) {
    const auto answer = second_.next(std::nullopt, emptyScan(), b, at(0, 0), map);
    b = b * robot::driveMotion(answer.command);
    ASSERT_GT(core::distance(core::position(b), {0, 0}), 2 * robot::circumscribedRadius(robot_));
    is_over = answer.gave_way;
  }
  EXPECT_TRUE(is_over);
  EXPECT_GT(core::distance(core::position(b), {0, 0}), kAside_m);
  // The first has more patience than the second.
  for (int i = 0; i < 8; ++i) first_.next(ahead(), emptyScan(), {0, 0, 0}, at(1, 0.65), map);
  EXPECT_FALSE(first_.givesWay());
}

}  // namespace
}  // namespace slam::navigate
