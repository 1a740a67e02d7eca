#include "libslam/wheels/path_scale.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libslam/core/random.h"

namespace slam::wheels {
namespace {

/// Wheels that report a true step times `scale`, with noise of so much on a metre, in steps of step_m.
PathScale afterDriving(double way_m, double step_m, double scale, double noise_m, double told,
                       Told by = Told::kByAll) {
  core::RandomStream chance(1, "wheels");
  PathScale path_scale(by);
  for (double s = 0; s < way_m; s += step_m) {
    const double wheels_m = scale * step_m + noise_m * std::sqrt(step_m) * chance.normal();
    path_scale.learn(path_scale.corrected({wheels_m, 0, 0}), {step_m, 0, 0}, told);
  }
  return path_scale;
}

TEST(PathScale, FindsHowLongAMetreIsAndSetsStepsRight) {
  EXPECT_EQ(PathScale(Told::kByAll).factor(), 1);
  const PathScale longer = afterDriving(30, 0.1, 1.05, 0, 0.9);
  EXPECT_NEAR(longer.factor(), 1 / 1.05, 1e-3);
  const core::Pose2 step = longer.corrected({1.05, -0.21, 0.3});
  EXPECT_NEAR(step.x, 1, 1e-3);
  EXPECT_NEAR(step.y, -0.2, 1e-3);
  EXPECT_EQ(step.phi, 0.3);
  EXPECT_NEAR(afterDriving(30, 0.1, 0.96, 0, 0.9).factor(), 1 / 0.96, 1e-3);
}

// Were steps compared, and not sums, the wheels' own noise would make their metres seem long: by (noise /
// step) squared, here 0.04.
TEST(PathScale, IsNotMovedByTheWheelsOwnNoise) {
  EXPECT_NEAR(afterDriving(400, 0.01, 1, 0.02, 0.9).factor(), 1, 0.006);
}

// The length of a jitter is positive, and its sum grows for ever.
TEST(PathScale, IsNotMovedByStandingWheelsThatJitterOrTurningOnesThatShift) {
  core::RandomStream chance(1, "wheels");
  PathScale path_scale = afterDriving(30, 0.1, 1, 0, 0.9);
  for (int i = 0; i < 100000; ++i) {
    const double s = i % 2 ? 0.002 : -0.002;
    path_scale.learn(path_scale.corrected({s, 0, 0}), {}, 1);
  }
  for (int i = 0; i < 10000; ++i)
    path_scale.learn(path_scale.corrected({0.004 * chance.normal(), 0, 0.1}), {0, 0, 0.1}, 1);
  EXPECT_NEAR(path_scale.factor(), 1, 0.004);
}

TEST(PathScale, ManyScansTellWhatEachAloneDoesNot) {
  EXPECT_NEAR(afterDriving(30, 0.0125, 1.05, 0, 0.1).factor(), 1 / 1.05, 1e-3);
  EXPECT_EQ(afterDriving(30, 0.0125, 1.05, 0, 0.03).factor(), 1);
  EXPECT_EQ(afterDriving(30, 0.0125, 1.05, 0, 0.4, Told::kByEach).factor(), 1);
  EXPECT_NEAR(afterDriving(30, 0.0125, 1.05, 0, 0.5, Told::kByEach).factor(), 1 / 1.05, 1e-3);
}

// Along a bare corridor the match goes where the wheels say, and is set right at its end.
TEST(PathScale, TheWayFromOneTellingPlaceToTheNextCounts) {
  PathScale path_scale(Told::kByAll);
  for (int i = 0; i < 10; ++i) {
    double ahead_m = 0;
    for (int step = 0; step < 30; ++step) {
      const core::Pose2 corrected = path_scale.corrected({1.05 * 0.1, 0, 0});
      const bool is_told = step < 3 || step >= 27;
      const double matched_m = is_told ? 0.1 - ahead_m : corrected.x;
      ahead_m += matched_m - 0.1;
      path_scale.learn(corrected, {matched_m, 0, 0}, is_told ? 0.95 : 0);
    }
  }
  EXPECT_NEAR(path_scale.factor(), 1 / 1.05, 0.01);
  // Of what it was when the pose was lost nothing is known.
  PathScale lost(Told::kByAll);
  for (int i = 0; i < 100; ++i) {
    lost.endPiece();
    for (int step = 0; step < 10; ++step) lost.learn({0.1, 0, 0}, {0.08, 0, 0}, step < 5 ? 0 : 0.3);
  }
  EXPECT_EQ(lost.factor(), 1);
}

TEST(PathScale, LearnsNothingFromWhatScansDoNotTell) {
  EXPECT_EQ(afterDriving(50, 0.1, 1.1, 0, 0.3).factor(), 1);
  // Nor across a gap.
  PathScale path_scale(Told::kByAll);
  for (int i = 0; i < 100; ++i) {
    path_scale.learn({0.2, 0, 0}, {0.1, 0, 0}, 1);
    path_scale.endPiece();
  }
  EXPECT_EQ(path_scale.factor(), 1);
}

TEST(PathScale, WheelsThatSlipNowAndThenHardlyCount) {
  PathScale path_scale(Told::kByAll);
  for (int i = 0; i < 400; ++i) {
    const bool slips = i % 50 >= 45;
    path_scale.learn(path_scale.corrected({0.1, 0, 0}), {slips ? 0.0 : 0.1, 0, 0}, 1);
  }
  EXPECT_NEAR(path_scale.factor(), 1, 0.03);
}

TEST(PathScale, LeapsOfOdometryAreForgotten) {
  PathScale path_scale = afterDriving(30, 0.1, 1.05, 0, 0.9);
  const double factor = path_scale.factor();
  for (const double leap_m : {1e6, 1e300, std::numeric_limits<double>::infinity(), std::nan("")})
    path_scale.learn({leap_m, 0, 0}, {0.1, 0, 0}, 1);
  EXPECT_EQ(path_scale.factor(), factor);
}

TEST(PathScale, FollowsAChangeOfLoadAndStaysWithinReason) {
  PathScale path_scale = afterDriving(200, 0.1, 1, 0.01, 0.9);
  for (int i = 0; i < 3000; ++i) path_scale.learn(path_scale.corrected({0.1, 0, 0}), {0.098, 0, 0}, 1);
  EXPECT_NEAR(path_scale.factor(), 0.98, 0.004);
  for (int i = 0; i < 5000; ++i) path_scale.learn(path_scale.corrected({0.1, 0, 0}), {0.05, 0, 0}, 1);
  EXPECT_GE(path_scale.factor(), 0.85 - 1e-12);
}

}  // namespace
}  // namespace slam::wheels
