#include "libslam/calibration/odometry_fit.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/calibration/drawn_motion.h"

namespace slam::calibration {
namespace {

using test_motion::driven;
using test_motion::kWheels;
using test_motion::Robot;

OdometryFit fitOf(const Robot& robot, int steps = 600, double offset_s = 0) {
  return fitOdometry({driven(robot, steps)}, kWheels, offset_s);
}

TEST(OdometryFit, FindsWhereTheLidarSitsAndThatAllElseIsRight) {
  Robot robot;
  robot.T_robot_lidar = {0.3, -0.15, 0.4};
  const auto fit = fitOf(robot);
  ASSERT_TRUE(fit.has_turns && fit.has_path && fit.has_position);
  // Exact motions: what is left is rounding.
  EXPECT_NEAR(fit.lidar_x_m.value, 0.3, 1e-6);
  EXPECT_NEAR(fit.lidar_y_m.value, -0.15, 1e-6);
  EXPECT_NEAR(fit.lidar_yaw_rad.value, 0.4, 1e-6);
  EXPECT_NEAR(fit.distance_scale.value, 1, 1e-6);
  EXPECT_NEAR(fit.turn_scale.value, 1, 1e-6);
  EXPECT_NEAR(fit.drift_rad_per_m.value, 0, 1e-6);
  // One that looks backwards.
  robot.T_robot_lidar = {-0.2, 0.1, core::kPi - 0.05};
  const auto backwards = fitOf(robot);
  EXPECT_NEAR(backwards.lidar_yaw_rad.value, core::kPi - 0.05, 1e-6);
  EXPECT_NEAR(backwards.lidar_x_m.value, -0.2, 1e-6);
  EXPECT_NEAR(backwards.distance_scale.value, 1, 1e-6);
}

// Wheels that count a tenth too much turn about the same centre: the lidar sits where it sits.
TEST(OdometryFit, TheLidarsPositionIsInRealMetres) {
  Robot robot;
  robot.T_robot_lidar = {0.5, 0.2, 0.1};
  robot.distance_scale = 1.1;
  const auto fit = fitOf(robot);
  EXPECT_NEAR(fit.distance_scale.value, 1.1, 1e-6);
  EXPECT_NEAR(fit.lidar_x_m.value, 0.5, 1e-6);
  EXPECT_NEAR(fit.lidar_y_m.value, 0.2, 1e-6);
  EXPECT_NEAR(fit.lidar_yaw_rad.value, 0.1, 1e-6);
}

TEST(OdometryFit, TellsAScaleOfTurnsFromADrift) {
  Robot robot;
  robot.T_robot_lidar = {0.1, 0, 0};
  robot.turn_scale = 0.95, robot.drift_rad_per_m = 0.03;
  const auto fit = fitOf(robot, 1200);
  // To the second order of the windows' turns: their paths are chords, not arcs.
  EXPECT_NEAR(fit.turn_scale.value, 0.95, 0.002);
  EXPECT_NEAR(fit.drift_rad_per_m.value, 0.03, 0.002);
  // Its windows are bent a little differently: within a tenth of what is off.
  EXPECT_NEAR(fit.distance_scale.value, 1, 0.005);
}

TEST(OdometryFit, ShiftsTheOdometrysClock) {
  Robot robot;
  robot.T_robot_lidar = {0.3, 0, 0};
  robot.clock_s = -0.35;  // its stamps are too early: 0.35 s are to be added
  const auto right = fitOf(robot, 600, 0.35);
  EXPECT_NEAR(right.turn_scale.value, 1, 1e-3);
  EXPECT_NEAR(right.lidar_x_m.value, 0.3, 2e-3);
  EXPECT_LT(right.turn_scale.width(), fitOf(robot, 600, 0).turn_scale.width() / 3);
  EXPECT_LT(right.turn_scale.width(), fitOf(robot, 600, -0.35).turn_scale.width() / 3);
}

TEST(OdometryFit, AFewWrongMatchesMoveNothing) {
  Robot robot;
  robot.T_robot_lidar = {0.3, -0.1, 0.2};
  auto stretch = driven(robot, 900);
  for (std::size_t k = 5; k < stretch.steps.size(); k += 60)
    stretch.steps[k].T_previous_lidar = stretch.steps[k].T_previous_lidar * core::Pose2{0.6, -0.4, 0.5};
  const auto fit = fitOdometry({stretch}, kWheels, 0);
  // The mean would be off by a tenth of these leaps.
  EXPECT_NEAR(fit.turn_scale.value, 1, 0.01);
  EXPECT_NEAR(fit.distance_scale.value, 1, 0.01);
  EXPECT_NEAR(fit.lidar_x_m.value, 0.3, 0.02);
  EXPECT_NEAR(fit.lidar_yaw_rad.value, 0.2, 0.01);
}

// 95 of 100, by the binomial distribution 49 to 60 of 60 in 999 of 1000 tests; and intervals are no wider
// than what the noise makes.
TEST(OdometryFit, IntervalsHoldTheTruthAsOftenAsTheySay) {
  constexpr int kTrials = 60;
  int turns = 0, scales = 0, yaws = 0, xs = 0, ys = 0;
  double width = 0, squares = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Robot robot;
    robot.T_robot_lidar = {0.2, 0.1, 0.3};
    robot.distance_scale = 1.02;
    robot.noise_m = 0.004, robot.noise_rad = 0.004, robot.seed = static_cast<std::uint64_t>(trial) + 1;
    const auto fit = fitOf(robot, 500);
    turns += fit.turn_scale.covers(1);
    scales += fit.distance_scale.covers(1.02);
    yaws += fit.lidar_yaw_rad.covers(0.3);
    xs += fit.lidar_x_m.covers(0.2), ys += fit.lidar_y_m.covers(0.1);
    width += fit.lidar_yaw_rad.width() / kTrials;
    squares += (fit.lidar_yaw_rad.value - 0.3) * (fit.lidar_yaw_rad.value - 0.3) / kTrials;
  }
  for (const auto& [name, covered] :
       std::map<std::string, int>{{"turns", turns}, {"scales", scales}, {"yaws", yaws}, {"x", xs}, {"y", ys}})
    EXPECT_GE(covered, 49) << name;
  // Four standard deviations of the values, within a third.
  EXPECT_NEAR(width, 2 * 1.96 * std::sqrt(squares), 1.3 * std::sqrt(squares));
}

TEST(OdometryFit, SaysWhatTheDriveDoesNotShow) {
  const auto straight = fitOdometry({driven({}, 600, 0)}, kWheels, 0);
  EXPECT_TRUE(straight.has_path);
  EXPECT_FALSE(straight.has_turns || straight.has_position);
  const auto spinning = fitOdometry({driven({}, 600, 1, 0)}, kWheels, 0);
  EXPECT_FALSE(spinning.has_path);
  EXPECT_TRUE(spinning.has_turns);
  const auto brief = fitOdometry({driven({}, 40)}, kWheels, 0);
  EXPECT_FALSE(brief.has_path || brief.has_turns);
  EXPECT_EQ(fitOdometry({driven({}, 600)}, "another stream", 0).windows, 0U);
  EXPECT_EQ(fitOdometry({}, kWheels, 0).windows, 0U);
}

TEST(OdometryFit, WindowsEndWhereScanMatchingIsNotSure) {
  auto stretch = driven({}, 600);
  const auto all = fitOdometry({stretch}, kWheels, 0);
  EXPECT_NEAR(all.path_m, 0.05 * 600, 1.5) << "nearly all of the way is in some window";
  // Every fourth step is not known: windows of three steps are no half metre, and no half radian.
  for (std::size_t k = 3; k < stretch.steps.size(); k += 4) stretch.steps[k].is_reliable = false;
  EXPECT_LT(fitOdometry({stretch}, kWheels, 0).windows, all.windows / 5);
  // Two stretches are not tied together.
  auto first = driven({}, 300);
  EXPECT_EQ(fitOdometry({first, first}, kWheels, 0).windows, 2 * fitOdometry({first}, kWheels, 0).windows);
}

}  // namespace
}  // namespace slam::calibration
