#include "libslam/tracking/motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/elementary.h"
#include "tests/keyframes/drawn_map.h"
#include "tests/scanmatch/drawn_rooms.h"

namespace slam::tracking {
namespace {

using core::Pose2;
using keyframes::test_maps::roundRoom;
using scanmatch_test::rectangle;

lidar::Scan scanAt(double time_s) {
  auto scan = roundRoom(5);
  scan.time_s = time_s;
  return scan;
}

lidar::Scan look(const std::vector<scanmatch_test::Wall>& walls, const Pose2& T_world_robot, double time_s) {
  core::RandomStream chance(1, "motion");
  auto scan = scanmatch_test::look(walls, T_world_robot, scanmatch_test::Lidar(), chance);
  scan.time_s = time_s;
  return scan;
}

/// A step as odometry has it, taken in as that.
void drive(Motion& motion, double time_s, const Pose2& T_step) {
  const auto scan = scanAt(time_s);
  motion.begin(scan, T_step, true);
  motion.setStep(T_step);
  motion.end(scan);
}
void driveOn(Motion& motion, int steps, double period_s, const Pose2& T_step, double& time_s) {
  for (int i = 0; i < steps; ++i, time_s += period_s) drive(motion, time_s, T_step);
}

TEST(Motion, GoesOnAsItDidForAsLongAsTheStepTakes) {
  keyframes::KeyframeMap map{keyframes::GraphOptions()};
  Motion motion(map);
  double time_s = 0;
  driveOn(motion, 20, 0.2, {0.1, 0, 0.02}, time_s);
  EXPECT_FALSE(motion.begin(scanAt(time_s), {}, false));
  EXPECT_NEAR(motion.step().x, 0.1, 0.01);
  EXPECT_NEAR(motion.step().phi, 0.02, 0.004);
  // Half a metre a second, whatever the time between two scans.
  Motion uneven(map);
  time_s = 0;
  for (int i = 0; i < 30; ++i) {
    const double since_s = i % 2 == 0 ? 0.2 : 0.4;
    time_s += since_s;
    drive(uneven, time_s, {0.5 * since_s, 0, 0});
  }
  EXPECT_FALSE(uneven.begin(scanAt(time_s + 0.8), {}, false));
  EXPECT_NEAR(uneven.step().x, 0.4, 0.02);
  EXPECT_NEAR(uneven.period_s(), 0.8, 1e-9);
}

TEST(Motion, ALeapIsNoOdometryAndIsSaid) {
  keyframes::KeyframeMap map{keyframes::GraphOptions()};
  Motion motion(map);
  double time_s = 0;
  driveOn(motion, 10, 0.2, {0.1, 0, 0}, time_s);
  EXPECT_FALSE(motion.begin(scanAt(time_s), {40, 0, 0}, true));
  EXPECT_NEAR(motion.step().x, 0.1, 0.01);  // what went on before stands in for it
  ASSERT_FALSE(map.journal().empty());
  EXPECT_EQ(map.journal().back().event, core::JournalEvent::kLeapt);
  EXPECT_EQ(map.journal().back().value, 40);
}

TEST(Motion, NoiseGrowsWithTheRootOfTimeAndWithTheWay) {
  keyframes::KeyframeMap map{keyframes::GraphOptions()};
  const auto sigmaAt = [&](double period_s, const Pose2& T_step) {
    Motion motion(map);
    double time_s = 0;
    driveOn(motion, 300, period_s, {}, time_s);
    return motion.predict(T_step, true).sigma_xy_m;
  };
  const double standing = sigmaAt(0.2, {});
  EXPECT_NEAR(sigmaAt(0.05, {}), standing / 2, 0.01 * standing);
  EXPECT_NEAR(sigmaAt(0.2, {0.5, 0, 0}) - standing, 0.5 * map.options().odometry_xy_per_m, 1e-9);
}

TEST(Motion, WhatWheelsSayOfATurnMayBelongToTheNextStep) {
  keyframes::KeyframeMap map{keyframes::GraphOptions()};
  Motion still(map), turning(map);
  double time_s = 0;
  driveOn(still, 10, 0.2, {}, time_s);
  time_s = 0;
  driveOn(turning, 9, 0.2, {}, time_s);
  driveOn(turning, 1, 0.2, {0, 0, 0.5}, time_s);
  EXPECT_GT(turning.predict({}, true).sigma_turn_rad, 2 * still.predict({}, true).sigma_turn_rad);
}

TEST(Motion, WheelsThatSlipTurnWithoutTheRobotAndGoNoFarther) {
  keyframes::KeyframeMap map{keyframes::GraphOptions()};
  Motion motion(map);
  double time_s = 0;
  driveOn(motion, 10, 0.2, {0.1, 0, 0}, time_s);
  motion.begin(scanAt(time_s), {0.1, 0, 0.2}, true);
  const Prediction by_wheels = motion.predict({0.1, 0, 0.2}, true);
  EXPECT_TRUE(motion.isSlip({0, 0, 0}, by_wheels));
  EXPECT_TRUE(motion.isSlip({0.1, 0, 0.1}, by_wheels));
  EXPECT_FALSE(motion.isSlip({1.5, 0, 0.2}, by_wheels));  // farther than wheels went
  EXPECT_FALSE(motion.isSlip({0.1, 0, 0.2 + 11 * by_wheels.sigma_turn_rad}, by_wheels));
}

TEST(Motion, TwoScansTellTheStepAndContradictAnother) {
  const auto walls = rectangle(0, 0, 8, 5);
  keyframes::KeyframeMap map{keyframes::GraphOptions()};
  Motion motion(map);
  const Pose2 T_before{3, 2, 0.3}, T_step{0.2, 0, 0.15};
  const auto first = look(walls, T_before, 0);
  motion.begin(first, {}, false);
  motion.end(first);
  const auto second = look(walls, T_before * T_step, 0.2);
  motion.begin(second, {}, false);
  EXPECT_FALSE(motion.isFoundFromScans());
  const auto found = motion.fromScans(second);
  ASSERT_TRUE(found.has_value());
  EXPECT_TRUE(motion.isFoundFromScans());
  EXPECT_LT(core::distance(*found, T_step), 0.03);
  EXPECT_NEAR(found->phi, T_step.phi, 0.02);
  const auto points = keyframes::pointsOf(second, map.options());
  EXPECT_LT(motion.brokenBy(points, T_step), 0.1);
  EXPECT_GT(motion.brokenBy(points, {0.2, 1.5, 0.15}), kBroken);
}

TEST(Motion, EveryLidarHasItsOwnScanBefore) {
  const auto walls = rectangle(0, 0, 8, 5);
  keyframes::KeyframeMap map{keyframes::GraphOptions()};
  Motion motion(map);
  auto front = look(walls, {3, 2, 0}, 0);
  motion.begin(front, {}, true);
  motion.end(front);
  auto rear = look(walls, {3, 2, core::kPi}, 0.1);
  rear.T_robot_lidar = {0, 0, core::kPi};
  motion.begin(rear, {0.1, 0, 0}, true);
  EXPECT_EQ(motion.before(), nullptr);
  motion.setStep({0.1, 0, 0});
  motion.end(rear);
  front.time_s = 0.2;
  motion.begin(front, {0.1, 0, 0}, true);
  ASSERT_NE(motion.before(), nullptr);
  EXPECT_EQ(motion.before()->scan.T_robot_lidar.phi, 0);
  EXPECT_NEAR(motion.before()->T_seen_robot.x, 0.1, 1e-12);  // the robot has moved since
}

}  // namespace
}  // namespace slam::tracking
