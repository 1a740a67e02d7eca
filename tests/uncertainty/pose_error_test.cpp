// How sure keyframes' poses are: by hand in one dimension after the other.
#include "libslam/uncertainty/pose_error.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"
#include "libslam/posegraph/marginals.h"
#include "tests/keyframes/drawn_map.h"

namespace slam::uncertainty {
namespace {

using core::kPi;
using Eigen::Matrix3d;
using keyframes::GraphOptions;
using keyframes::Keyframe;
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

// Of a keyframe that has turned: in its own axes, as edges have it.
TEST(PoseError, WhatIsKnownFromTheFirstViewIsInTheBodysAxes) {
  KeyframeMap map{GraphOptions{}};
  addRow(map, 1);
  addKeyframe(map, {0, 0, 0.6}, roundRoom(5), 1, 0);
  // No doubt of the first one; the second is sure along x of the map, and less along y.
  map.keyframes()[1].covariance = diagonal(1e-4, 1e-2, 1e-5);
  noteMatch(map, evidenceBy({{0, diagonal(100, 10, 50)}}), diagonal(1e-6, 1e-6, 1e-7));
  EXPECT_EQ(map.keyframe(1).matched_to, 0);
  Matrix3d R = Matrix3d::Identity();
  R(0, 0) = R(1, 1) = std::cos(0.6), R(1, 0) = std::sin(0.6), R(0, 1) = -R(1, 0);
  expectNear(map.keyframe(1).information, R.transpose() * diagonal(1e4, 1e2, 1e5) * R, 1);
}

/// What is known after a match that odometry's prior, map frame, takes part in.
PoseError after(const KeyframeMap& map, const scanmatch::MatchEvidence& evidence, const Matrix3d& prior,
                const core::Pose2& here, const Before& before) {
  return errorAfterMatch(map, evidence, kInformationScale * evidence.information() + prior, here, before);
}

TEST(PoseError, WithoutAnyEvidenceIsThatOfBeforeAndOfTheStep) {
  KeyframeMap map{GraphOptions{}};
  addRow(map, 2);
  const Matrix3d odometry = diagonal(0.01, 0.02, 0.001);
  const auto error =
      after(map, {}, odometry.inverse(), {4, 0, 0}, {{1, 0, 0}, diagonal(0.1, 0.2, 0.04), odometry});
  expectNear(error.noise, Matrix3d::Zero());
  expectNear(error.stays, Matrix3d::Identity());
  expectNear(error.least, odometry);
  // Three metres on, the heading's error shows across: 9 times its variance.
  Matrix3d expected = diagonal(0.11, 0.2 + 9 * 0.04 + 0.02, 0.041);
  expected(1, 2) = expected(2, 1) = 3 * 0.04;
  expectNear(error.covariance, expected);
}

// The match alone counts, as the prior is nearly nothing. What the first keyframe saw errs as this match
// does, and its heading's error shows 2 m off.
TEST(PoseError, WithOneKeyframeIsThatOfBothViews) {
  KeyframeMap map{GraphOptions{}};
  addRow(map, 1);
  const auto evidence = evidenceBy({{0, diagonal(50, 50, 200)}});
  const auto error = after(map, evidence, 1e-9 * Matrix3d::Identity(), {2, 0, 0},
                           {{0, 0, 0}, diagonal(9, 9, 9), diagonal(1, 1, 1)});
  expectNear(error.noise, diagonal(0.02, 0.02, 0.005), 1e-6);
  expectNear(error.stays, Matrix3d::Zero(), 1e-6);
  Matrix3d expected = diagonal(0.04, 0.04 + 4 * 0.005, 0.01);
  expected(1, 2) = expected(2, 1) = 2 * 0.005;
  expectNear(error.covariance, expected, 1e-6);
}

// Half of the weight each: the means' errors add up as if they had one cause, those of the match and of the
// step by their squares.
TEST(PoseError, OfAMeanIsTheMeanOfTheErrors) {
  KeyframeMap map{GraphOptions{}};
  addRow(map, 2);
  map.keyframes()[0].root = diagonal(0.3, 0.1, 0);
  const auto evidence = evidenceBy({{0, diagonal(50, 50, 50)}});
  const Matrix3d prior = kInformationScale * diagonal(50, 50, 50);
  const auto error =
      after(map, evidence, prior, {0, 0, 0}, {{0, 0, 0}, diagonal(0.25, 0.04, 0), diagonal(0.1, 0.1, 0.1)});
  expectNear(error.stays, 0.5 * Matrix3d::Identity());
  expectNear(error.noise, diagonal(0.005, 0.005, 0.005));
  expectNear(error.least, diagonal(0.03, 0.03, 0.03));
  expectNear(error.covariance, diagonal(0.4 * 0.4 + 0.03, 0.15 * 0.15 + 0.03, 0.03));
}

// Two views that share a past do not make it surer.
TEST(PoseError, OfTwoViewsIsNoSmallerThanThatOfOne) {
  KeyframeMap map{GraphOptions{}};
  addRow(map, 3);
  for (auto& keyframe : map.keyframes()) keyframe.root = diagonal(0.2, 0.2, 0);
  const Matrix3d nothing = 1e-9 * Matrix3d::Identity();
  const Before before{{0, 0, 0}, diagonal(1, 1, 1), diagonal(1, 1, 1)};
  const auto one = after(map, evidenceBy({{0, diagonal(80, 80, 80)}}), nothing, {0, 0, 0}, before);
  const auto two = after(map, evidenceBy({{0, diagonal(60, 60, 60)}, {1, diagonal(20, 20, 20)}}), nothing,
                         {0, 0, 0}, before);
  EXPECT_NEAR(one.covariance(0, 0), 0.04 + 1.0 / 80, 1e-6);
  expectNear(two.covariance, one.covariance, 1e-6);
}

TEST(PoseError, AMatchIsNotedFromTheViewThatSaysMostOfThePosition) {
  KeyframeMap map{GraphOptions{}};
  addRow(map, 2);
  addKeyframe(map, {2, 0, kPi / 2}, roundRoom(5), 2, 1);
  map.keyframes()[0].covariance = diagonal(0.1, 0.1, 0.01);
  map.keyframes()[1].covariance = diagonal(0.2, 0.2, 0.02);
  Matrix3d now = diagonal(0.25, 0.22 + 0.02, 0.03);  // a metre from keyframe 1, whose heading errs
  now(1, 2) = now(2, 1) = 0.02;
  map.keyframes()[2].covariance = now;
  const auto evidence = evidenceBy({{0, diagonal(1, 4, 900)}, {1, diagonal(5, 1, 1)}});
  noteMatch(map, evidence, diagonal(1e-4, 1e-4, 1e-4));
  const Keyframe& noted = map.keyframe(2);
  EXPECT_EQ(noted.matched_to, 1);
  // Grown by 0.05 along the map's x, which is the body's -y, by 0.02 along its y, and by 0.01 in heading.
  expectNear(noted.information, diagonal(50, 20, 100), 1e-6);
}

TEST(PoseError, ANotedMatchTellsNoMoreThanAMatchCan) {
  KeyframeMap map{GraphOptions{}};
  addRow(map, 2);
  map.keyframes()[0].covariance = map.keyframes()[1].covariance = diagonal(0.1, 0.1, 0);
  map.keyframes()[1].covariance(0, 0) = 0.35;
  noteMatch(map, evidenceBy({{0, diagonal(5, 5, 5)}}), diagonal(0.01, 0.02, 0.005));
  EXPECT_EQ(map.keyframe(1).matched_to, 0);
  expectNear(map.keyframe(1).information, diagonal(4, 50, 200), 1e-6);
  // Nothing seen, nothing noted.
  addKeyframe(map, {2, 0, 0}, roundRoom(5), 2, 1);
  map.keyframes()[2].matched_to = -1;
  noteMatch(map, {}, Matrix3d::Identity());
  EXPECT_EQ(map.keyframe(2).matched_to, -1);
}

TEST(PoseError, IsRaisedWhereTheMatchAloneTellsLess) {
  PoseError error{};
  error.noise = diagonal(1, 4, 1), error.least = diagonal(2, 5, 2), error.covariance = diagonal(7, 9, 3);
  raiseNoise(error, diagonal(3, 1, 1));
  expectNear(error.noise, diagonal(3, 4, 1));
  expectNear(error.beyond, diagonal(2, 0, 0));
  expectNear(error.least, diagonal(4, 5, 2));
  expectNear(error.covariance, diagonal(9, 9, 3));
}

}  // namespace
}  // namespace slam::uncertainty
