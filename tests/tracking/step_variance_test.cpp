#include "libslam/tracking/step_variance.h"

#include <gtest/gtest.h>

#include "libslam/core/random.h"

namespace slam::tracking {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d diagonal(double x, double y, double phi) {
  return Vector3d(x, y, phi).asDiagonal();
}

const Matrix3d kAssumed = diagonal(4e-4, 4e-4, 1e-4), kNoise = diagonal(1e-5, 1e-5, 1e-6);

/// Steps that err by `way` and `turn` times the variance assumed, and matches that take away all of it.
StepVariance after(int steps, double way, double turn, const Matrix3d& gain = Matrix3d::Identity()) {
  core::RandomStream random(1, "steps");
  StepVariance variance;
  for (int i = 0; i < steps; ++i) {
    Vector3d moved;
    for (int c = 0; c < 3; ++c)
      moved[c] = random.normal(std::sqrt((c == 2 ? turn : way) * kAssumed(c, c) + 2 * kNoise(c, c)));
    variance.add(gain * moved, gain, kAssumed, gain * kNoise * gain.transpose(), kNoise);
  }
  return variance;
}

TEST(StepVariance, IsAsAssumedAtFirst) {
  EXPECT_TRUE(StepVariance().of(kAssumed).isApprox(kAssumed));
}

TEST(StepVariance, LearnsDistanceAndTurnApart) {
  const Matrix3d learnt = after(5000, 0.1, 0.5).of(kAssumed);
  EXPECT_NEAR(learnt(0, 0) / kAssumed(0, 0), 0.1, 0.01);
  EXPECT_NEAR(learnt(1, 1) / kAssumed(1, 1), 0.1, 0.01);
  EXPECT_NEAR(learnt(2, 2) / kAssumed(2, 2), 0.5, 0.03);
}

TEST(StepVariance, TakesOffWhatTheScansErrBy) {
  const Matrix3d learnt = after(5000, 0, 0).of(kAssumed);
  EXPECT_LT(learnt(0, 0) / kAssumed(0, 0), 0.01);
  EXPECT_GE(learnt(0, 0), 9e-4 * kAssumed(0, 0)) << "but it is never nothing";
}

// A match that holds the pose half as strongly as odometry does moves it by two thirds of the error.
TEST(StepVariance, KnowsThatAMatchTakesAwayAShareAlone) {
  const Matrix3d learnt = after(5000, 0.3, 0.3, 0.66 * Matrix3d::Identity()).of(kAssumed);
  EXPECT_NEAR(learnt(0, 0) / kAssumed(0, 0), 0.3, 0.03);
}

TEST(StepVariance, LearnsNothingWhereNothingHoldsTheMatch) {
  const Matrix3d learnt = after(1000, 0.1, 0.1, diagonal(0.4, 0.4, 1)).of(kAssumed);
  EXPECT_DOUBLE_EQ(learnt(0, 0), kAssumed(0, 0));
  EXPECT_LT(learnt(2, 2), 0.2 * kAssumed(2, 2));
}

TEST(StepVariance, ASlipIsNoSpread) {
  StepVariance variance = after(990, 0.1, 0.1);
  for (int i = 0; i < 10; ++i) variance.add({5, 0, 0}, Matrix3d::Identity(), kAssumed, kNoise, kNoise);
  EXPECT_LT(variance.of(kAssumed)(0, 0), 0.25 * kAssumed(0, 0));
}

}  // namespace
}  // namespace slam::tracking
