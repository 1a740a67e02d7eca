// How sure keyframes' poses are: by hand in one dimension after the other.
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"
#include "libslam/posegraph/marginals.h"
#include "tests/keyframes/drawn_map.h"

namespace slam::keyframes {
namespace {

using core::kPi;
using Eigen::Matrix3d;
using scanmatch::kInformationScale;
using test_maps::addKeyframe;
using test_maps::addRow;
using test_maps::diagonal;
using test_maps::roundRoom;

void expectNear(const Matrix3d& actual, const Matrix3d& expected, double tolerance = 1e-9) {
  EXPECT_LT((actual - expected).cwiseAbs().maxCoeff(), tolerance) << actual << "\ninstead of\n" << expected;
}

TEST(PointNoise, IsOneAsLongAsNothingIsKnown) {
  EXPECT_DOUBLE_EQ(PointNoise{}.variance(), 1);
  PointNoise nothing;
  nothing.add({});
  EXPECT_DOUBLE_EQ(nothing.variance(), 1);
}

TEST(PointNoise, IsTheMeanSquareOverAllScans) {
  PointNoise noise;
  scanmatch::MatchEvidence scan;
  scan.squared = 30, scan.dimensions = 100;
  noise.add(scan);
  EXPECT_DOUBLE_EQ(noise.variance(), 0.3);
  scan.squared = 270, scan.dimensions = 100;
  noise.add(scan);
  EXPECT_DOUBLE_EQ(noise.variance(), 1.5);
}

// Points that all err alike: weights 5/6, 4/6 ... 1/6 of the lags, twice, and the point itself.
TEST(PointNoise, GrowsByWhatNeighboursHaveInCommon) {
  scanmatch::MatchEvidence scan;
  scan.squared = scan.dimensions = 100;
  scan.lagged.fill(100);
  PointNoise alike;
  alike.add(scan);
  EXPECT_NEAR(alike.variance(), 6, 1e-9);
  scan.lagged = {50, 0, 0, 0, 0};
  PointNoise near;
  near.add(scan);
  EXPECT_NEAR(near.variance(), 1 + 2 * 5.0 / 6 * 0.5, 1e-9);
  // Errors that alternate make nothing surer than independent ones.
  scan.lagged = {-90, 80, -70, 60, -50};
  PointNoise apart;
  apart.add(scan);
  EXPECT_NEAR(apart.variance(), 1, 1e-9);
}

std::vector<Matrix3d> covariancesOfWitnesses(const KeyframeMap& map) {
  return covariancesOf(posegraph::Marginals(witnessGraph(map.graph(), map.graph().poses(), map.witnesses()),
                                            posegraph::Marginals::Open::kBounded));
}

/// Three keyframes in a row, edges of odometry of 10 cm and 10 mrad.
struct Chain {
  KeyframeMap map{GraphOptions{}};
  Chain() {
    for (int k = 0; k < 3; ++k) {
      const core::Pose2 T{1.0 * k, 0, 0};
      addKeyframe(map, T, roundRoom(5), k, -1);
      map.keyframes().back().matched_to = -1;
      if (k == 0) continue;
      posegraph::Edge edge;
      edge.from = k - 1, edge.to = k, edge.T_from_to = {1, 0, 0}, edge.information = diagonal(100, 100, 1e4);
      map.keyframes().back().odometry_edge = map.graph().addEdge(edge);
    }
  }
  void addLoop(const std::vector<std::pair<int, int>>& ends, const Matrix3d& information) {
    std::vector<posegraph::Edge> edges;
    for (const auto& [from, to] : ends) {
      posegraph::Edge edge;
      edge.from = from, edge.to = to, edge.T_from_to = core::between(map.pose(from), map.pose(to));
      edge.information = information, edge.kind = posegraph::EdgeKind::kLoop;
      edges.push_back(edge);
    }
    map.addLoop(edges);
  }
  Matrix3d ofLast() const { return covariancesOfWitnesses(map)[2]; }
};

TEST(Witnesses, AChainsErrorsAddUp) {
  const Chain chain;
  const auto all = covariancesOfWitnesses(chain.map);
  ASSERT_EQ(all.size(), 3U);
  expectNear(all[0], Matrix3d::Zero());
  expectNear(all[1], diagonal(0.01, 0.01, 1e-4));
  // The first edge's turn shows a metre on.
  Matrix3d expected = diagonal(0.02, 0.0201, 2e-4);
  expected(1, 2) = expected(2, 1) = 1e-4;
  expectNear(all[2], expected);
}

TEST(Witnesses, WhatWasMatchedIsKnownFromThereAndNotTwice) {
  Chain chain;
  chain.map.keyframes()[2].matched_to = 0;
  chain.map.keyframes()[2].information = diagonal(400, 400, 4e4);
  // Whatever other edges say the same again.
  chain.map.tie(2, {0, 1}, chain.map.pose(2), 1e6 * Matrix3d::Identity(), 1);
  expectNear(chain.ofLast(), diagonal(0.0025, 0.0025, 2.5e-5));
  const auto graph = witnessGraph(chain.map.graph(), chain.map.graph().poses(), chain.map.witnesses());
  EXPECT_EQ(graph.edges().size(), 2U);
  EXPECT_TRUE(graph.isFixed(0));
}

// Each of a loop's keyframes is one witness, however many edges it has: of all together as much counts as one
// match tells, in the unit of points that err together, and of two views.
TEST(Witnesses, ALoopTellsAsMuchAsOneMatch) {
  const double told = 1 / (kBothViews * kInformationScale);
  Chain once;
  once.addLoop({{0, 2}}, diagonal(100, 0.01, 0.01));
  EXPECT_NEAR(once.ofLast()(0, 0), 1 / (50 + told * 100), 1e-9);
  Chain twice;  // two edges of one keyframe, as one match is shared
  twice.addLoop({{0, 2}, {0, 2}}, diagonal(50, 0.01, 0.01));
  EXPECT_NEAR(twice.ofLast()(0, 0), 1 / (50 + told * 100), 1e-9);
  Chain confirmed;  // keyframe 1 says so, too
  confirmed.addLoop({{0, 1}, {0, 2}}, diagonal(100, 0.01, 0.01));
  const double one = told * 50;
  // Along x: 0 to 1 by odometry and half a loop, then odometry; beside it half a loop from 0 to 2.
  EXPECT_NEAR(confirmed.ofLast()(0, 0), 1 / (1 / (1 / (100 + one) + 0.01) + one), 1e-9);
}

TEST(Witnesses, EveryLoopCountsByItselfAndOnlyWhileItIsOn) {
  const double told = 1 / (kBothViews * kInformationScale);
  Chain two;
  two.addLoop({{0, 2}}, diagonal(100, 0.01, 0.01));
  two.map.tie(2, {1}, two.map.pose(2), Matrix3d::Identity(), 1);  // ends it
  two.addLoop({{0, 2}}, diagonal(100, 0.01, 0.01));
  EXPECT_NEAR(two.ofLast()(0, 0), 1 / (50 + 2 * told * 100), 1e-9);
  two.map.graph().setOn(static_cast<int>(two.map.graph().edges().size()) - 1, false);
  EXPECT_NEAR(two.ofLast()(0, 0), 1 / (50 + told * 100), 1e-9);
  // Scans whose points err twice as much, squared.
  scanmatch::MatchEvidence scan;
  scan.squared = 400, scan.dimensions = 200;
  two.map.pointNoise().add(scan);
  EXPECT_NEAR(two.ofLast()(0, 0), 1 / (50 + 0.5 * told * 100), 1e-9);
}

/// A winding way, with a turn in it and a keyframe that was matched to one of long ago.
struct WindingWay : Chain {
  void driveOn(int count) {
    for (int i = 0; i < count; ++i) {
      const int k = map.size();
      const core::Pose2 T = map.pose(k - 1) * core::Pose2{0.8, 0.1 * (k % 3), 0.4};
      addKeyframe(map, T, roundRoom(5), k, -1);
      posegraph::Edge edge;
      edge.from = k - 1, edge.to = k, edge.T_from_to = core::between(map.pose(k - 1), T);
      edge.information = diagonal(100 + k, 150, 1e4);
      edge.information(0, 2) = edge.information(2, 0) = 30.0 * k;
      map.keyframes().back().odometry_edge = map.graph().addEdge(edge);
      map.keyframes().back().matched_to = k % 4 == 0 ? k - 3 : -1;
      map.keyframes().back().information = diagonal(300, 200, 2e4);
    }
  }
  /// The largest difference from what all witnesses say together, over all pairs; of variances about 0.1.
  double worst() const {
    const posegraph::Marginals all(witnessGraph(map.graph(), map.graph().poses(), map.witnesses()));
    double worst = 0;
    for (int a = 0; a < map.size(); ++a)
      for (int b = 0; b < map.size(); ++b)
        if (a != b)
          worst = std::max(worst, (map.wayCovariance(a, b) - all.relative(a, b)).cwiseAbs().maxCoeff());
    return worst;
  }
};

TEST(Witnesses, TheWayBetweenTwoIsKnownWithoutAskingAll) {
  WindingWay way;
  way.driveOn(9);
  EXPECT_LT(way.worst(), 1e-9) << "no loop yet: a tree";
  way.addLoop({{1, 11}, {2, 11}}, diagonal(40, 30, 400));
  EXPECT_GT(way.worst(), 1e-3) << "nobody was told of the loop";
  test_maps::settleAtOnce(way.map);
  EXPECT_LT(way.worst(), 1e-9);
  way.driveOn(9);
  EXPECT_LT(way.worst(), 1e-9) << "some came since";
}

TEST(Witnesses, KeyframesThatCameSinceAreAsSureAsAllTogetherSay) {
  WindingWay way;
  way.driveOn(9);
  way.addLoop({{1, 11}, {2, 11}}, diagonal(40, 30, 400));
  posegraph::OptimizeOptions options;
  options.robust = "none";
  Settling settling(way.map, options);
  double unlimited = std::numeric_limits<double>::infinity();
  ASSERT_TRUE(settling.advance(unlimited));
  const int known = way.map.size();
  way.driveOn(6);
  for (auto& one : way.map.keyframes()) one.noise = diagonal(0.2, 0.3, 0.4);
  way.map.settle(settling.result());
  const auto all = covariancesOfWitnesses(way.map);
  for (int k = 1; k < way.map.size(); ++k) {
    const Keyframe& one = way.map.keyframe(k);
    expectNear(one.covariance, all[static_cast<size_t>(k)]);
    const Matrix3d noise = k < known ? Matrix3d::Zero().eval() : one.noise;  // as it was when that began
    expectNear(one.root * one.root, one.covariance + noise);
  }
}

}  // namespace
}  // namespace slam::keyframes
