// What a matched pose errs by, from scan to scan: by hand in one dimension after the other.
#include "libslam/uncertainty/pose_error.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"
#include "tests/keyframes/drawn_map.h"

namespace slam::uncertainty {
namespace {

using Eigen::Matrix3d;
using keyframes::GraphOptions;
using keyframes::KeyframeMap;
using keyframes::moved;
using keyframes::test_maps::addKeyframe;
using keyframes::test_maps::addRow;
using keyframes::test_maps::diagonal;
using keyframes::test_maps::roundRoom;
using scanmatch::kInformationScale;

void expectNear(const Matrix3d& actual, const Matrix3d& expected, double tolerance = 1e-9) {
  EXPECT_LT((actual - expected).cwiseAbs().maxCoeff(), tolerance) << actual << "\ninstead of\n" << expected;
}

scanmatch::MatchEvidence evidenceBy(const std::vector<scanmatch::ViewInformation>& views) {
  scanmatch::MatchEvidence evidence;
  evidence.by_view = views;
  return evidence;
}

// Whoever turns a body about `from` moves what is firmly joined to it.
TEST(PoseError, OfATurnShowsAsAShiftFartherOff) {
  const core::Point2 from{1, 2}, to{4, 1};
  const double turn_rad = 1e-6;
  const core::Pose2 about = core::Pose2{1, 2, turn_rad} * core::Pose2{-1, -2, 0};  // a turn about `from`
  const core::Point2 shifted = about * to;
  const Eigen::Vector3d shown = moved(from, to) * Eigen::Vector3d(0, 0, turn_rad);
  EXPECT_NEAR(shown.x(), shifted.x - to.x, 1e-11);
  EXPECT_NEAR(shown.y(), shifted.y - to.y, 1e-11);
  EXPECT_DOUBLE_EQ(shown.z(), turn_rad);
  expectNear(moved(from, from), Matrix3d::Identity());
}

/// After a match that odometry's prior, map frame, takes part in.
struct After {
  PoseError error;
  keyframes::ErrorSamples errors, own;  ///< own: what is new
  After(const KeyframeMap& map, const scanmatch::MatchEvidence& evidence, const core::Pose2& here,
        const Followed& before)
      : error(errorAfterMatch(map, evidence,
                              kInformationScale * evidence.information() + before.odometry.inverse())),
        errors(errorsAfterMatch(map, evidence, error, here, before, 77)) {
    own.addNew(error.noise + error.stays * before.odometry * error.stays.transpose(), 77);
  }
  /// Besides what is new.
  Matrix3d inherited() const {
    keyframes::ErrorSamples rest = errors;
    rest.add(-Matrix3d::Identity(), own);
    return rest.covariance();
  }
};

keyframes::ErrorSamples drawn(const Matrix3d& covariance, std::uint64_t draw) {
  keyframes::ErrorSamples result;
  result.addNew(covariance, draw);
  return result;
}

/// Odometry that says next to nothing.
const Matrix3d kNothing = 1e9 * Matrix3d::Identity();

TEST(PoseError, WithoutAnyEvidenceIsThatOfBeforeAndOfTheStep) {
  KeyframeMap map{GraphOptions{}};
  addRow(map, 2);
  const Matrix3d odometry = diagonal(0.01, 0.02, 0.001);
  const auto before = drawn(diagonal(0.1, 0.2, 0.04), 1);
  const After after(map, {}, {4, 0, 0}, {{1, 0, 0}, before, odometry});
  expectNear(after.error.noise, Matrix3d::Zero());
  expectNear(after.error.stays, Matrix3d::Identity());
  // Three metres on, the heading's error shows across.
  const Matrix3d J = moved({1, 0}, {4, 0});
  expectNear(after.inherited(), J * before.covariance() * J.transpose(), 1e-6);
  expectNear(after.own.covariance(), drawn(odometry, 77).covariance());
}

// The match alone counts. What the first keyframe saw errs as this match does, and the keyframe does not.
TEST(PoseError, WithOneKeyframeIsThatOfBothViews) {
  KeyframeMap map{GraphOptions{}};
  addRow(map, 1);
  const auto evidence = evidenceBy({{0, diagonal(50, 50, 200)}});
  noteFirst(map, errorAfterMatch(map, evidence, kInformationScale * evidence.information()));
  expectNear(map.keyframe(0).noise, diagonal(0.02, 0.02, 0.005), 1e-6);
  EXPECT_LT(map.errorsOf(0).covariance().norm(), 1e-9);
  const After after(map, evidence, {2, 0, 0}, {{0, 0, 0}, drawn(diagonal(9, 9, 9), 1), kNothing});
  expectNear(after.error.noise, diagonal(0.02, 0.02, 0.005), 1e-6);
  expectNear(after.error.stays, Matrix3d::Zero(), 1e-6);
  // Its heading's error shows 2 m off.
  const Matrix3d J = moved({0, 0}, {2, 0});
  expectNear(after.inherited(), J * map.keyframe(0).surfaces.covariance() * J.transpose(), 1e-4);
  addKeyframe(map, {1, 0, 0}, roundRoom(5), 1, 0);
  noteFirst(map, PoseError{});
  EXPECT_GT(map.keyframe(0).noise(0, 0), 0) << "and so it stays";
}

// Points that lie off are pulled less the farther they are off: they move a match as their weights have it,
// and hold it by less.
TEST(PoseError, OfAMatchGoesByHowFirmlyItHolds) {
  KeyframeMap map{GraphOptions{}};
  addRow(map, 1);
  auto evidence = evidenceBy({{0, diagonal(60, 100, 100)}});
  evidence.beyond_slope = diagonal(40, 0, 0);
  scanmatch::MatchEvidence residuals;
  residuals.squared = 100, residuals.pulled = 50, residuals.dimensions = 100;
  map.pointNoise().add(residuals);
  const After firm(map, evidence, {0, 0, 0}, {{0, 0, 0}, {}, kNothing});
  expectNear(firm.error.noise, 0.5 * diagonal(100.0 / (60 * 60), 0.01, 0.01), 1e-6);
  expectNear(firm.error.stays, Matrix3d::Zero(), 1e-6);
  // Odometry beside it, which is as sure as the weights have it.
  const Matrix3d odometry = diagonal(1, 1, 1) / (kInformationScale * 100);
  const After held(map, evidence, {0, 0, 0}, {{0, 0, 0}, {}, odometry});
  expectNear(held.error.stays, diagonal(1 - 60.0 / 160, 0.5, 0.5), 1e-9);
  // Of a match that had not come to rest more may be taken than there is.
  evidence.by_view[0].information(0, 0) = -60, evidence.beyond_slope(0, 0) = 160;
  const After loose(map, evidence, {0, 0, 0}, {{0, 0, 0}, {}, kNothing});
  EXPECT_NEAR(loose.error.noise(0, 0), 0.5 / 100, 1e-9);
}

// Half of the weight each.
TEST(PoseError, OfAMeanIsTheMeanOfTheErrors) {
  KeyframeMap map{GraphOptions{}};
  addRow(map, 2);
  const auto of_view = drawn(diagonal(0.3, 0.1, 0.2), 1), before = drawn(diagonal(0.25, 0.04, 0.1), 2);
  map.setErrors(0, of_view);
  const auto evidence = evidenceBy({{0, diagonal(50, 50, 50)}});
  const Matrix3d odometry = diagonal(0.1, 0.1, 0.1);  // a fifth of 50: as much as the match
  const After after(map, evidence, {0, 0, 0}, {{0, 0, 0}, before, odometry});
  expectNear(after.error.stays, 0.5 * Matrix3d::Identity());
  expectNear(after.error.noise, diagonal(0.005, 0.005, 0.005));
  // The match's noise, and a quarter of odometry's.
  expectNear(after.own.covariance(), drawn(diagonal(0.03, 0.03, 0.03), 77).covariance(), 1e-6);
  keyframes::ErrorSamples mean;
  mean.add(0.5 * Matrix3d::Identity(), of_view), mean.add(0.5 * Matrix3d::Identity(), before);
  expectNear(after.inherited(), mean.covariance(), 1e-6);
}

// Two views that err alike, as they share a past, do not make it surer.
TEST(PoseError, OfTwoViewsIsNoSmallerThanThatOfOne) {
  KeyframeMap map{GraphOptions{}};
  addRow(map, 3);
  for (int k = 0; k < map.size(); ++k) map.setErrors(k, drawn(diagonal(0.04, 0.04, 0), 5));
  const Followed before{{0, 0, 0}, drawn(diagonal(1, 1, 1), 6), kNothing};
  const auto by_one = evidenceBy({{0, diagonal(80, 80, 80)}}),
             by_two = evidenceBy({{0, diagonal(60, 60, 60)}, {1, diagonal(20, 20, 20)}});
  const After one(map, by_one, {0, 0, 0}, before), two(map, by_two, {0, 0, 0}, before);
  expectNear(one.inherited(), drawn(diagonal(0.04, 0.04, 0), 5).covariance(), 1e-5);
  expectNear(two.errors.covariance(), one.errors.covariance(), 1e-5);
}

// All that are matched to a view err by its noise alike.
TEST(PoseError, AViewsNoiseIsTheSameForAllThatAreMatchedToIt) {
  KeyframeMap map{GraphOptions{}};
  addRow(map, 2);
  map.keyframes()[0].noise = diagonal(0.5, 0.5, 0.1);
  map.setErrors(0, {});
  const auto evidence = evidenceBy({{0, diagonal(100, 100, 100)}});
  const After after(map, evidence, {0, 0, 0}, {{0, 0, 0}, {}, kNothing});
  expectNear(after.inherited(), map.keyframe(0).surfaces.covariance(), 1e-5);
  EXPECT_GT(after.inherited()(0, 0), 0.2);
}

TEST(PoseError, IsRaisedWhereTheMatchAloneTellsLess) {
  PoseError error{};
  error.noise = diagonal(1, 4, 1);
  raiseNoise(error, diagonal(3, 1, 1));
  expectNear(error.noise, diagonal(3, 4, 1));
  expectNear(error.beyond, diagonal(2, 0, 0));
}

}  // namespace
}  // namespace slam::uncertainty
