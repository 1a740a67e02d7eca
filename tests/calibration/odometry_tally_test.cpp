#include "libslam/calibration/odometry_tally.h"

#include <gtest/gtest.h>

namespace slam::calibration {
namespace {

using core::Pose2;

/// Poses a tenth of a second apart.
OdometryFigures figuresOf(const std::vector<Pose2>& poses) {
  OdometryTally tally;
  double time_s = 100;
  for (const auto& pose : poses) tally.add(time_s += 0.1, pose);
  return tally.figures("wheels");
}

TEST(OdometryTally, CountsPathAndTurnsBothWays) {
  const auto figures = figuresOf({{0, 0, 0}, {0.1, 0, 0.2}, {0.1, 0.2, 0.1}, {0, 0.2, -0.1}});
  EXPECT_EQ(figures.stream, "wheels");
  EXPECT_EQ(figures.readings, 4U);
  EXPECT_NEAR(figures.path_m, 0.4, 1e-12);
  EXPECT_NEAR(figures.turned_rad, 0.5, 1e-12);
  EXPECT_EQ(figures.jumps, 0U);
  EXPECT_EQ(figures.largest_jump_m, 0);
  // Across the back it is a small turn.
  EXPECT_NEAR(figuresOf({{0, 0, 3.1}, {0, 0, -3.1}}).turned_rad, 2 * core::kPi - 6.2, 1e-12);
}

TEST(OdometryTally, LeavesJumpsOutOfThePath) {
  std::vector<Pose2> poses;
  poses.reserve(50);
  for (int i = 0; i < 50; ++i) poses.push_back({0.1 * i + (i >= 20 ? 4 : 0) + (i >= 30 ? 2 : 0), 0, 0});
  const auto figures = figuresOf(poses);
  EXPECT_EQ(figures.jumps, 2U);
  EXPECT_NEAR(figures.path_m, 4.7, 1e-9);
  EXPECT_NEAR(figures.largest_jump_m, 4.1, 1e-9);
  EXPECT_NEAR(figures.largest_jump_at_s, 102.1, 1e-9);
  // A step of half a metre is none, however fast.
  EXPECT_EQ(figuresOf({{0, 0, 0}, {0.5, 0, 0}}).jumps, 0U);
  poses.clear();
  for (int i = 0; i < 50; ++i) poses.push_back({0.1 * i + (i >= 25 ? 0.42 : 0), 0, 0});
  EXPECT_EQ(figuresOf(poses).jumps, 1U) << "0.52 m";
}

TEST(OdometryTally, ASpinIsAJumpToo) {
  const auto figures = figuresOf({{0, 0, 0}, {0, 0, 0.45}, {0, 0, 1.0}, {0, 0, 1.2}});
  EXPECT_EQ(figures.jumps, 1U) << "0.55 rad in a tenth of a second";
  EXPECT_NEAR(figures.turned_rad, 0.65, 1e-12);
}

TEST(OdometryTally, StampsSayWhetherAStepIsTooFar) {
  OdometryTally tally;
  tally.add(10, {0, 0, 0});
  tally.add(12, {2, 0, 1});  // 1 m/s
  tally.add(11, {4, 0, 1});  // back in time: nobody moves at once
  tally.add(std::nullopt, {4.1, 0, 1});
  tally.add(std::nullopt, {6.1, 0, 1});
  const auto figures = tally.figures("o");
  EXPECT_EQ(figures.jumps, 2U);
  EXPECT_NEAR(figures.path_m, 2.1, 1e-12);
  EXPECT_NEAR(figures.turned_rad, 1, 1e-12);
}

/// A car at 10 m/s in a wide left turn, which does not jump, its readings a tenth of a second apart.
OdometryTally car(int readings) {
  OdometryTally tally;
  for (int i = 0; i < readings; ++i) {
    const double turned_rad = 0.05 * i;
    tally.add(100 + 0.1 * i, {20 * std::sin(turned_rad), 20 * (1 - std::cos(turned_rad)), turned_rad});
  }
  return tally;
}

TEST(OdometryTally, WhatIsFastAllTheTimeDoesNotJump) {
  const auto figures = car(101).figures("car");
  EXPECT_EQ(figures.jumps, 0U);
  EXPECT_NEAR(figures.path_m, 100, 0.1);  // chords of a circle of 20 m
  EXPECT_NEAR(figures.turned_rad, 5, 1e-9) << "its turns count as its path does";
}

TEST(OdometryTally, TheLargestJumpIsOneOfTheJumps) {
  auto tally = car(101);
  const double turned_rad = 5;
  const Pose2 there{20 * std::sin(turned_rad), 20 * (1 - std::cos(turned_rad)), turned_rad};
  // 3 s without a reading: 30 m that were driven. Then 9 m in a hundredth of a second.
  const Pose2 on = there * Pose2{30, 0, 0};
  tally.add(113, on);
  tally.add(113.01, on * Pose2{9, 0, 0});
  const auto figures = tally.figures("car");
  EXPECT_EQ(figures.jumps, 1U);
  EXPECT_NEAR(figures.largest_jump_m, 9, 1e-9);
  EXPECT_NEAR(figures.largest_jump_at_s, 113.01, 1e-9);
  EXPECT_NEAR(figures.path_m, 130, 0.1);
}

}  // namespace
}  // namespace slam::calibration
