#include "libslam/robot/odometer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace slam::robot {
namespace {

using core::degToRad;
using core::kPi;

/// Bounds are five standard errors of the estimator: by chance a right program fails once in a million.
constexpr double kSigmas = 5;

OdometryOptions perfect() {
  OdometryOptions options;
  options.alpha1 = options.alpha2 = options.alpha3 = options.alpha4 = 0;
  options.scale = 1;
  options.heading_bias_radpm = 0;
  return options;
}

core::Pose2 once(const OdometryOptions& options, const Command& command) {
  return Odometer(options, 1).update(command, command.duration_s);
}

void expectNear(const core::Pose2& found, const core::Pose2& expected, double tolerance) {
  EXPECT_NEAR(found.x, expected.x, tolerance);
  EXPECT_NEAR(found.y, expected.y, tolerance);
  EXPECT_NEAR(core::angleDifference(found.phi, expected.phi), 0, tolerance);
}

std::vector<Command> wandering(int count) {
  core::RandomStream random(7, "test commands");
  std::vector<Command> commands;
  for (int i = 0; i < count; ++i)
    commands.push_back({random.uniform(-0.5, 0.5), random.uniform(-1, 1), random.uniform(0, 0.4)});
  return commands;
}

TEST(Odometer, WithEverythingOffIsTheOlderNoiseBitForBit) {
  const OdometryOptions options;
  Odometer odometer(options, 5);
  core::RandomStream random(5, "odometry");
  for (const Command& command : wandering(200)) {
    const core::Pose2 expected = sampleOdometry(driveMotion(command), options, random);
    const core::Pose2 found = odometer.update(command, command.duration_s);
    ASSERT_EQ(found.x, expected.x);
    ASSERT_EQ(found.y, expected.y);
    ASSERT_EQ(found.phi, expected.phi);
  }
}

TEST(Odometer, DrawsTheOlderNoiseWhateverElseIsOn) {
  OdometryOptions slipping;
  slipping.slips_per_m = 3, slipping.gyro = true;
  Odometer odometer(slipping, 5), plain(OdometryOptions(), 5);
  odometer.update({0, 0, 1}, 1), plain.update({0, 0, 1}, 1);
  // A drive so short that no slip falls into it: the same noise as if slips were off.
  const Command nudge{1e-9, 0, 1};
  EXPECT_EQ(odometer.update(nudge, 1).x, plain.update(nudge, 1).x);
}

TEST(WheelErrors, OfOneWheelCurveAStraightDrive) {
  OdometryOptions options = perfect();
  options.wheel_radius_left_error = 0.02;  // larger than assumed: it reports too little
  const core::Pose2 reported = once(options, {0.5, 0, 4});
  const double left_m = 2 / 1.02, turn_rad = (2 - left_m) / options.wheel_base_m;
  expectNear(reported, driveMotion({0.5 * (left_m + 2), turn_rad, 1}), 1e-12);
  EXPECT_GT(reported.phi, 0);
}

TEST(WheelErrors, OfBothWheelsScaleTheDistance) {
  OdometryOptions options = perfect();
  options.wheel_radius_left_error = options.wheel_radius_right_error = -0.05;
  expectNear(once(options, {0.5, 0, 4}), {2 / 0.95, 0, 0}, 1e-12);
}

TEST(WheelErrors, OfTheBaseScaleTheTurn) {
  OdometryOptions options = perfect();
  options.wheel_base_error = 0.1;  // wider than assumed: a turn takes more travel, and more is reported
  expectNear(once(options, {0, 1, 1}), {0, 0, 1.1}, 1e-12);
  expectNear(once(options, {0.5, 0, 2}), {1, 0, 0}, 1e-12);
}

TEST(WheelErrors, HoldForTurnsOfMoreThanHalfAround) {
  OdometryOptions options = perfect();
  options.wheel_base_error = 0.1;
  expectNear(once(options, {0, 1, 5}), {0, 0, 5.5}, 1e-12);
}

TEST(Slips, HaveTheStatedRateAndLength) {
  OdometryOptions options = perfect();
  options.slips_per_m = 2, options.slip_m = 0.05;
  WheelEncoder wheel(options, 0, {3, "slips"});
  const int steps = 200000;
  const double step_m = 0.01;
  double slipped_m = 0;
  int slips = 0;
  for (int i = 0; i < steps; ++i) {
    const double more_m = wheel.measure(step_m) - step_m;
    slipped_m += more_m;
    slips += more_m > 1e-12;
    ASSERT_LT(more_m, 5 * 2 * options.slip_m);
  }
  const double expected = options.slips_per_m * steps * step_m;  // 4000
  // Counts are Poisson; two in one step count as one here, at most 1 % of them: rate * step = 0.02.
  EXPECT_NEAR(slips, expected, kSigmas * std::sqrt(expected) + 0.01 * expected);
  // A compound Poisson sum: variance is count * E[length^2], and E of a uniform 0 .. 2 m squared is 4/3 m^2.
  EXPECT_NEAR(slipped_m, expected * options.slip_m, kSigmas * std::sqrt(expected * 4 / 3) * options.slip_m);
}

TEST(Slips, AreInTheDirectionOfTravelAndNoneAtRest) {
  OdometryOptions options = perfect();
  options.slips_per_m = 100, options.slip_m = 0.01;
  WheelEncoder wheel(options, 0, {3, "slips"});
  EXPECT_LT(wheel.measure(-1), -1.3);
  EXPECT_EQ(wheel.measure(0), 0);
}

TEST(Slips, OfTheTwoWheelsAreIndependent) {
  OdometryOptions options = perfect();
  options.slips_per_m = 1;
  Odometer odometer(options, 3);
  int left = 0, right = 0;
  for (int i = 0; i < 1000; ++i) {
    const double turn_rad = odometer.update({0.1, 0, 1}, 1).phi;
    left += turn_rad<0, right += turn_rad> 0;
  }
  EXPECT_GT(left, 50);
  EXPECT_GT(right, 50);
}

TEST(Ticks, LoseNothingOverManySteps) {
  OdometryOptions options = perfect();
  options.tick_m = 0.01;
  WheelEncoder wheel(options, 0, {1, "slips"});
  double sum_m = 0;
  for (int i = 0; i < 1000; ++i) {
    const double reported_m = wheel.measure(0.0037);
    EXPECT_NEAR(std::remainder(reported_m, 0.01), 0, 1e-12);  // whole ticks
    sum_m += reported_m;
    ASSERT_LT(std::abs(sum_m - 0.0037 * (i + 1)), 0.01 + 1e-9);
  }
  EXPECT_NEAR(wheel.measure(-0.0037 * 1000) + sum_m, 0, 0.01 + 1e-9);  // and back
}

TEST(Ticks, QuantiseWhatAStepReports) {
  OdometryOptions options = perfect();
  options.tick_m = 0.1;
  Odometer odometer(options, 1);
  EXPECT_EQ(odometer.update({0.06, 0, 1}, 1).x, 0);
  EXPECT_DOUBLE_EQ(odometer.update({0.06, 0, 1}, 1).x, 0.1);
}

TEST(Gyro, WithoutErrorsIsTheTrueHeadingWhateverTheWheelsSay) {
  OdometryOptions options = perfect();
  options.gyro = true, options.wheel_base_error = 0.2, options.wheel_radius_left_error = 0.05;
  Odometer odometer(options, 1);
  core::Pose2 T_odom_robot;
  double heading_rad = 0;
  for (const Command& command : wandering(100)) {
    T_odom_robot = T_odom_robot * odometer.update(command, command.duration_s);
    heading_rad += command.turn_rate_radps * command.duration_s;
    ASSERT_NEAR(core::angleDifference(T_odom_robot.phi, heading_rad), 0, 1e-12);
  }
}

TEST(Gyro, RightsTheWholeArcWhereOnlyTheBaseIsWrong) {
  OdometryOptions options = perfect();
  options.gyro = true, options.wheel_base_error = 0.2;
  const Command arc{0.5, 0.4, 1};
  const core::Pose2 reported = once(options, arc), truly = driveMotion(arc);
  EXPECT_NEAR(std::atan2(reported.y, reported.x), std::atan2(truly.y, truly.x), 1e-12);
  // The chord is that of an arc turned by 0.48 instead of 0.4 rad: shorter by about (0.48^2 - 0.4^2) / 24.
  EXPECT_NEAR(std::hypot(reported.x, reported.y), std::hypot(truly.x, truly.y), 0.0016);
}

TEST(Gyro, BiasTurnsARobotThatStands) {
  OdometryOptions options = perfect();
  options.gyro = true, options.gyro_bias_radps = 0.01;
  EXPECT_NEAR(Odometer(options, 1).update({0.5, 0, 1}, 20).phi, 0.2, 1e-12);  // 19 s against an obstacle
}

TEST(Gyro, NoiseAndBiasWalkGrowWithTheRootOfTime) {
  OdometryOptions noisy = perfect(), walking = perfect();
  noisy.gyro = walking.gyro = true;
  noisy.gyro_noise_radps = 0.02, walking.gyro_bias_walk_radps = 0.003;
  const int robots = 2000, steps = 25;
  const double step_s = 0.16;  // 4 s in all
  double noise2 = 0, bias2 = 0;
  for (int i = 0; i < robots; ++i) {
    Odometer a(noisy, static_cast<std::uint64_t>(i)), b(walking, static_cast<std::uint64_t>(i));
    double heading_rad = 0;
    for (int k = 0; k < steps; ++k) {
      heading_rad += a.update({0, 0, step_s}, step_s).phi;
      b.update({0, 0, step_s}, step_s);
    }
    const double bias_radps = b.update({0, 0, 1}, 1).phi;  // one second at the bias reached
    noise2 += heading_rad * heading_rad, bias2 += bias_radps * bias_radps;
  }
  const double standard_error = 1 / std::sqrt(2.0 * robots);  // of a standard deviation, relative
  EXPECT_NEAR(std::sqrt(noise2 / robots), 0.02 * 2, 0.04 * kSigmas * standard_error);
  EXPECT_NEAR(std::sqrt(bias2 / robots), 0.003 * 2, 0.006 * kSigmas * standard_error);
}

}  // namespace
}  // namespace slam::robot
