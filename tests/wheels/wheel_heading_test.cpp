#include "libslam/wheels/wheel_heading.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libslam/core/random.h"

namespace slam::wheels {
namespace {

using core::Pose2;

/// Wheels that turn too little: by so much per metre and per radian of the true motion, with noise.
struct Wheels {
  double per_metre = 0, per_radian = 0, noise_per_metre = 0, noise_per_radian = 0;

  Pose2 of(const Pose2& T_true, core::RandomStream& chance) const {
    const double noise = std::sqrt(std::abs(T_true.x)) * noise_per_metre * chance.normal() +
                         std::sqrt(std::abs(T_true.phi)) * noise_per_radian * chance.normal();
    return {T_true.x, 0, (T_true.phi - per_metre * T_true.x) / (1 + per_radian) + noise};
  }
};

/// Straight ahead and a turn on the spot by turns, `rounds` times; the step ahead may be backwards.
WheelHeading afterDriving(const Wheels& wheels, int rounds, double step_m, double told = 1) {
  core::RandomStream chance(1, "heading");
  WheelHeading heading;
  for (int i = 0; i < rounds; ++i)
    for (const Pose2& T_true : {Pose2{i % 3 ? step_m : -step_m, 0, 0}, Pose2{0, 0, i % 2 ? 0.3 : -0.2}})
      heading.learn(heading.corrected(wheels.of(T_true, chance)), T_true, told);
  return heading;
}

TEST(WheelHeading, FindsHowFarWheelsTurnPerMetreAndPerRadian) {
  const WheelHeading heading = afterDriving({0.06, 0.05, 0, 0}, 200, 0.6);
  EXPECT_NEAR(heading.perMetre(), 0.06, 0.002);
  EXPECT_NEAR(heading.perRadian(), 0.05, 0.01);
  // A step of one metre by wheels that turn too little was an arc to the left.
  const Pose2 step = heading.corrected({1, 0, -0.06 / 1.05});
  EXPECT_NEAR(step.phi, 0, 0.004);
  EXPECT_NEAR(step.y, std::sin(0.03), 0.002);
  EXPECT_NEAR(core::hypot(step.x, step.y), 1, 1e-12);
}

TEST(WheelHeading, IsTheSameForShortSteps) {
  core::RandomStream chance(1, "heading");
  WheelHeading heading;
  const Wheels wheels{0.06, 0, 0.01, 0};
  for (int i = 0; i < 2000; ++i) {
    const Pose2 T_true{0.02, 0, 0};
    heading.learn(heading.corrected(wheels.of(T_true, chance)), T_true, 1);
  }
  EXPECT_NEAR(heading.perMetre(), 0.06, 0.004);
}

TEST(WheelHeading, ShowsHowFarWheelsAreToBeBelieved) {
  const WheelHeading rough = afterDriving({0, 0, 0.05, 0.05}, 300, 0.6);
  EXPECT_NEAR(rough.sigma_rad({1, 0, 0}), 0.05, 0.01);
  EXPECT_NEAR(rough.sigma_rad({4, 0, 0}), 2 * rough.sigma_rad({1, 0, 0}), 1e-12);
  const WheelHeading fine = afterDriving({0.03, 0, 0.002, 0.002}, 300, 0.6);
  EXPECT_LT(fine.sigma_rad({1, 0, 0}), 0.006);
}

// Good wheels on bad ground: some hundred pieces of 0.6 m and 0.25 rad leave 0.009 and 0.017 open.
TEST(WheelHeading, NoiseIsNoError) {
  const WheelHeading heading = afterDriving({0, 0, 0.05, 0.05}, 300, 0.6);
  EXPECT_NEAR(heading.perMetre(), 0, 0.02);
  EXPECT_NEAR(heading.perRadian(), 0, 0.04);
}

TEST(WheelHeading, LearnsNothingFromWhatScansDoNotTell) {
  EXPECT_EQ(afterDriving({0.06, 0.05, 0, 0}, 100, 0.4, 0.3).perMetre(), 0);
  // Nor across a gap, nor from a leap.
  WheelHeading heading;
  for (int i = 0; i < 100; ++i) {
    heading.learn({0.3, 0, 0}, {0.3, 0, 0.05}, 1);
    heading.endPiece();
  }
  const double infinite = std::numeric_limits<double>::infinity();
  for (const Pose2& leap : {Pose2{30, 0, 0}, Pose2{0, 0, 3.1}, Pose2{infinite, 0, 0},
                            Pose2{std::nan(""), 0, 0}, Pose2{0, 0, std::nan("")}})
    heading.learn(leap, {0.5, 0, 0.05}, 1);
  EXPECT_EQ(heading.perMetre(), 0);
  EXPECT_EQ(heading.perRadian(), 0);
}

TEST(WheelHeading, SlipsHardlyCount) {
  WheelHeading heading;
  for (int i = 0; i < 200; ++i) {
    const double slip = i % 40 == 20 ? 0.8 : 0;
    heading.learn(heading.corrected({0.5, 0, slip}), {0.5, 0, 0}, 1);
  }
  EXPECT_NEAR(heading.perMetre(), 0, 0.01);
}

// A tyre that loses air.
TEST(WheelHeading, FollowsChange) {
  core::RandomStream chance(1, "heading");
  WheelHeading heading;
  for (int i = 0; i < 1200; ++i) {
    const Pose2 T_true{0.5, 0, 0};
    heading.learn(heading.corrected(Wheels{i < 600 ? 0.0 : 0.05, 0, 0.01, 0}.of(T_true, chance)), T_true, 1);
  }
  EXPECT_NEAR(heading.perMetre(), 0.05, 0.01);
}

/// By how much it is off on a metre, on average over 600 m after as many, where wheels turn by `error` per
/// metre to one side for so many metres and then to the other.
double offWhereErrorsTurn(double error, int every_m) {
  core::RandomStream chance(1, "heading");
  WheelHeading heading;
  double off = 0;
  for (int i = 0; i < 2400; ++i) {
    const Wheels wheels{i / 2 / every_m % 2 == 0 ? error : -error, 0, 0.01, 0};
    const Pose2 T_true{0.5, 0, 0};
    if (i >= 1200) off += std::abs(heading.perMetre() - wheels.per_metre) / 1200;
    heading.learn(heading.corrected(wheels.of(T_true, chance)), T_true, 1);
  }
  return off;
}

// On every floor otherwise: what was long ago counts for little. Where it is always the same, all counts.
TEST(WheelHeading, RemembersAsFarBackAsItTells) {
  EXPECT_LT(offWhereErrorsTurn(0.02, 50), 0.01);
  EXPECT_LT(offWhereErrorsTurn(0.02, 100000), 0.002);
}

}  // namespace
}  // namespace slam::wheels
