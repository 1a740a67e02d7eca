// What loops tell, and what follows when all poses are found anew.
#include <gtest/gtest.h>

#include <algorithm>

#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"
#include "tests/keyframes/drawn_map.h"

namespace slam::keyframes {
namespace {

using Eigen::Matrix3d;
using scanmatch::kInformationScale;
using test_maps::addKeyframe;
using test_maps::diagonal;
using test_maps::roundRoom;

TEST(PointNoise, IsOneAsLongAsNothingIsKnown) {
  EXPECT_DOUBLE_EQ(PointNoise{}.variance(), 1);
  PointNoise nothing;
  nothing.add({});
  EXPECT_DOUBLE_EQ(nothing.variance(), 1);
}

TEST(PointNoise, IsTheMeanSquareOverAllScans) {
  PointNoise noise;
  scanmatch::MatchEvidence scan;
  EXPECT_EQ(noise.variance(), 1);
  EXPECT_EQ(noise.varianceOfPull(), 1);
  scan.squared = 30, scan.pulled = 20, scan.dimensions = 100;
  noise.add(scan);
  EXPECT_DOUBLE_EQ(noise.variance(), 0.3);
  EXPECT_DOUBLE_EQ(noise.varianceOfPull(), 0.2);
  scan.squared = 270, scan.dimensions = 100;
  noise.add(scan);
  EXPECT_DOUBLE_EQ(noise.variance(), 1.5);
}

// Points that all err alike: weights 5/6, 4/6 ... 1/6 of the lags, twice, and the point itself.
TEST(PointNoise, GrowsByWhatNeighboursHaveInCommon) {
  scanmatch::MatchEvidence scan;
  scan.squared = scan.dimensions = 100, scan.pulled = 50;
  scan.lagged.fill(100);
  PointNoise alike;
  alike.add(scan);
  EXPECT_NEAR(alike.variance(), 6, 1e-9);
  EXPECT_NEAR(alike.varianceOfPull(), 3, 1e-9);
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

/// Three keyframes in a row, a metre apart.
struct Chain {
  KeyframeMap map{GraphOptions{}};
  Chain() {
    for (int k = 0; k < 3; ++k) add();
  }
  int add() {
    const int k = map.size();
    return addKeyframe(map, {1.0 * k, 0, 0}, roundRoom(5), k, k - 1);
  }
  void addLoop(const std::vector<std::pair<int, int>>& ends) {
    std::vector<posegraph::Edge> edges;
    for (const auto& [from, to] : ends) {
      posegraph::Edge edge;
      edge.from = from, edge.to = to, edge.T_from_to = core::between(map.pose(from), map.pose(to));
      edge.kind = posegraph::EdgeKind::kLoop;
      edges.push_back(edge);
    }
    map.addLoop(edges);
  }
  std::vector<double> shares() const {
    std::vector<double> result;
    for (const LoopEdge& edge : map.loopEdges()) result.push_back(edge.share);
    return result;
  }
};
using Shares = std::vector<double>;
const double kTold = 1 / (kBothViews * kInformationScale);

// Each of a loop's keyframes is one witness, however many edges it has: of all together as much counts as one
// match tells, in the unit of points that err together, and of two views.
TEST(LoopEdges, ALoopTellsAsMuchAsOneMatch) {
  Chain once, twice, confirmed;
  once.addLoop({{0, 2}});
  EXPECT_EQ(once.shares(), Shares{kTold});
  twice.addLoop({{0, 2}, {0, 2}});
  EXPECT_EQ(twice.shares(), Shares(2, kTold)) << "two edges of one keyframe, as one match is shared";
  confirmed.addLoop({{0, 1}, {0, 2}});
  EXPECT_EQ(confirmed.shares(), Shares(2, kTold / 2)) << "keyframe 1 says so, too";
}

TEST(LoopEdges, EveryLoopCountsByItselfAndOnlyWhileItIsOn) {
  Chain two;
  two.addLoop({{0, 2}});
  two.map.tie(2, {1}, two.map.pose(2), Eigen::Matrix3d::Identity(), 1);  // ends it
  two.addLoop({{0, 1}, {0, 2}});
  EXPECT_EQ(two.shares(), (Shares{kTold, kTold / 2, kTold / 2}));
  two.map.graph().setOn(static_cast<int>(two.map.graph().edges().size()) - 1, false);
  EXPECT_EQ(two.shares(), (Shares{kTold, kTold / 2}));
  // Scans whose points err twice as much, squared.
  scanmatch::MatchEvidence scan;
  scan.squared = 400, scan.dimensions = 200;
  two.map.pointNoise().add(scan);
  EXPECT_EQ(two.shares(), (Shares{kTold / 2, kTold / 4}));
}

ErrorSamples drawn(double variance, std::uint64_t draw) {
  ErrorSamples result;
  result.addNew(diagonal(variance, variance, 0), draw);
  return result;
}

double apart(const KeyframeMap& map, int a, int b) {
  return wayCovariance(map.errorsOf(a), map.pose(a), map.errorsOf(b), map.pose(b))(0, 0);
}

// Two of three were there when that began; the third, and one that came from it, go with the second.
TEST(Settle, WhatCameSinceLiesAndErrsFromTheOneBeforeAsItDid) {
  Chain chain;
  chain.add();
  for (int k = 1; k < 4; ++k) {
    ErrorSamples errors = chain.map.errorsOf(k - 1);
    errors.add(Eigen::Matrix3d::Identity(), drawn(1, static_cast<std::uint64_t>(k)));
    chain.map.setErrors(k, errors);
  }
  const double next = apart(chain.map, 1, 2), after = apart(chain.map, 2, 3);
  EXPECT_GT(std::min(next, after), 0.5);
  Settled found;
  found.poses = {{0, 0, 0}, {1, 0.5, core::kPi / 2}};
  found.errors = {{}, drawn(0.01, 9)};
  chain.map.settle(found);
  EXPECT_EQ(chain.map.revision(), 1);
  EXPECT_NEAR(chain.map.pose(3).x, 1, 1e-12);
  EXPECT_NEAR(chain.map.pose(3).y, 2.5, 1e-12);
  EXPECT_EQ(chain.map.errorsOf(1).covariance(), found.errors[1].covariance());
  const auto more = [&chain](int k) {
    ErrorSamples of_step = chain.map.errorsOf(k);
    of_step.add(-Eigen::Matrix3d::Identity(), chain.map.errorsOf(k - 1));
    return of_step.covariance()(0, 0);
  };
  EXPECT_NEAR(more(2), next, 1e-5) << "as much more as before";
  EXPECT_NEAR(more(3), after, 1e-5);
}

// What a scan saw errs by its pose, and by its noise, the same for all that are matched to it.
TEST(KeyframeErrors, SurfacesErrByThePoseAndTheNoiseToo) {
  Chain chain;
  chain.map.keyframes()[1].noise = diagonal(4, 1, 0.01);
  chain.map.setErrors(1, drawn(1, 5));
  const Eigen::Matrix3d of_pose = chain.map.errorsOf(1).covariance();
  EXPECT_LT((of_pose - drawn(1, 5).covariance()).norm(), 1e-5);
  EXPECT_NEAR(chain.map.keyframe(1).surfaces.covariance()(0, 0), 5, 2);
  chain.map.keyframes()[2].noise = diagonal(4, 1, 0.01);
  chain.map.setErrors(2, drawn(1, 5));
  EXPECT_GT(wayCovariance(chain.map.keyframe(1).surfaces, {}, chain.map.keyframe(2).surfaces, {})(0, 0), 4)
      << "each has its own";
}

TEST(Settle, PosesAloneLeaveErrorsAsTheyWere) {
  Chain chain;
  chain.map.setErrors(1, drawn(1, 5));
  const Eigen::Matrix3d before = chain.map.errorsOf(1).covariance();
  Settled found;
  found.poses = {{0, 0, 0}, {1, 1, 0}, {2, 1, 0}};
  chain.map.settle(found);
  EXPECT_EQ(chain.map.pose(2).y, 1);
  EXPECT_EQ(chain.map.errorsOf(1).covariance(), before);
}

}  // namespace
}  // namespace slam::keyframes
