// Errors that are drawn: what they have in common stays common, and their covariance is that of what was
// drawn.
#include "libslam/keyframes/error_samples.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "libslam/keyframes/matching.h"

namespace slam::keyframes {
namespace {

using core::Pose2;
using Eigen::Matrix3d;

Matrix3d someCovariance() {
  Matrix3d covariance;
  covariance << 4, 1, 0.2, 1, 2, -0.1, 0.2, -0.1, 0.09;
  return covariance;
}

ErrorSamples drawnFrom(const Matrix3d& covariance, std::uint64_t draw) {
  ErrorSamples result;
  result.addNew(covariance, draw);
  return result;
}

TEST(ErrorSamples, AreNoErrorBeforeAnythingComes) {
  EXPECT_EQ(ErrorSamples().covariance(), Matrix3d::Zero());
  ErrorSamples cleared = drawnFrom(someCovariance(), 1);
  cleared.clear();
  EXPECT_EQ(cleared.covariance(), Matrix3d::Zero());
}

// By each draw's own covariance the true one has to look right in the mean: so has a squared error.
TEST(ErrorSamples, SquaredErrorsByTheirCovarianceAreRightInTheMean) {
  double square = 0;
  constexpr int kDraws = 2000;
  for (int draw = 0; draw < kDraws; ++draw)
    square += (drawnFrom(someCovariance(), static_cast<std::uint64_t>(draw)).covariance().inverse() *
               someCovariance())
                  .trace();
  EXPECT_NEAR(square / kDraws / 3, 1, 0.02);
}

TEST(ErrorSamples, TheSameNumberIsDrawnAlikeAndAnotherOneIndependently) {
  const ErrorSamples one = drawnFrom(someCovariance(), 7), same = drawnFrom(someCovariance(), 7),
                     other = drawnFrom(someCovariance(), 8);
  for (int i = 0; i < ErrorSamples::kCount; ++i) EXPECT_EQ(one.sample(i), same.sample(i));
  double common = 0, all = 0;
  for (std::uint64_t draw = 0; draw < 200; ++draw) {
    ErrorSamples sum = drawnFrom(Matrix3d::Identity(), draw);
    all += sum.covariance().trace();
    sum.add(Matrix3d::Identity(), drawnFrom(Matrix3d::Identity(), draw + 1));
    common += sum.covariance().trace();
  }
  EXPECT_NEAR(common / all, 2, 0.05);
  EXPECT_NE(one.sample(0), other.sample(0));
}

TEST(ErrorSamples, AnOpenDirectionOrNothingIsDrawnToo) {
  const Eigen::Vector3d along(0.6, 0.8, 0);
  const Matrix3d line = drawnFrom(along * along.transpose(), 3).covariance();
  EXPECT_GT(along.dot(line * along), 0.5);
  EXPECT_NEAR(line(2, 2), 0, 1e-12);
  EXPECT_NEAR(Eigen::Vector3d(-0.8, 0.6, 0).dot(line * Eigen::Vector3d(-0.8, 0.6, 0)), 0, 1e-9);
  EXPECT_EQ(drawnFrom(Matrix3d::Zero(), 3).covariance(), Matrix3d::Zero());
}

TEST(ErrorSamples, AShareIsTakenOverDrawByDraw) {
  const ErrorSamples of = drawnFrom(someCovariance(), 11);
  Matrix3d share;
  share << 0.5, 0, 3, 0, 0.25, -2, 0, 0, 1;
  ErrorSamples taken;
  taken.add(share, of);
  const Matrix3d expected = share * of.covariance() * share.transpose();
  EXPECT_LT((taken.covariance() - expected).norm(), 1e-5 * expected.norm());
  taken.add(-share, of);
  EXPECT_LT(taken.covariance().norm(), 1e-9) << "the same error, and nothing is left of it";
}

// A kilometre's drift, and a metre that is known to a centimetre.
TEST(WayCovariance, IsOfWhatTheTwoDoNotHaveInCommon) {
  const Pose2 a{300, 400, 2}, b{301, 400.5, -1};
  const ErrorSamples drift = drawnFrom(Eigen::Vector3d(25, 16, 1e-2).asDiagonal(), 1);
  ErrorSamples of_b;
  of_b.add(moved(core::position(a), core::position(b)), drift);
  EXPECT_LT(wayCovariance(drift, a, of_b, b).diagonal().maxCoeff(), 1e-9);
  const Matrix3d step = Eigen::Vector3d(1e-4, 4e-4, 1e-6).asDiagonal();
  of_b.addNew(step, 2);
  const Matrix3d own = drawnFrom(step, 2).covariance();
  // In a's frame, which is turned.
  const Eigen::Vector3d x_axis(std::cos(2), std::sin(2), 0);
  const Matrix3d way = wayCovariance(drift, a, of_b, b);
  EXPECT_NEAR(way(0, 0), x_axis.dot(own * x_axis), 1e-6);
  EXPECT_NEAR(way(2, 2), own(2, 2), 1e-9);
  // Seen from the other end the metre between them turns with b's heading.
  EXPECT_GT(wayCovariance(of_b, b, drift, a)(0, 0), 0.5e-4);
}

}  // namespace
}  // namespace slam::keyframes
