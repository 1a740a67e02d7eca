#include "libslam/loops/loop_judge.h"

#include <gtest/gtest.h>

#include "libslam/keyframes/search.h"
#include "libslam/posegraph/marginals.h"

namespace slam::loops {
namespace {

using core::kPi;
using keyframes::Hypothesis;

/// Three keyframes in a row along the map's y, all of which look along it: edges of 10 cm and 10 mrad, once
/// they are taken to err by four times what they claim.
struct Way {
  posegraph::PoseGraph graph;
  keyframes::Keyframes keyframes;
  int asked = 0;
  Way() {
    for (int k = 0; k < 3; ++k) {
      graph.addNode({2, 1.0 * k, kPi / 2});
      keyframes::Keyframe keyframe{};
      // Map frame: what is known the least is x, across the way.
      keyframe.noise = Eigen::Vector3d(0.08, 0.005, 1e-4).asDiagonal();
      keyframes.push_back(keyframe);
      if (k == 0) continue;
      posegraph::Edge edge;
      edge.from = k - 1, edge.to = k, edge.T_from_to = {1, 0, 0};
      edge.information = 16 * Eigen::Vector3d(100, 100, 1e4).asDiagonal();
      graph.addEdge(edge);
    }
    graph.setFixed(0);
  }
  LoopJudge judge() {
    return LoopJudge(graph.poses(), keyframes, [this](int a, int b) {
      ++asked;
      return posegraph::Marginals(graph).relative(a, b);
    });
  }
};

Hypothesis placeAt(const core::Pose2& T_map_robot, int keyframe = 2, int old_keyframe = 0) {
  Hypothesis place{};
  place.keyframe = keyframe, place.old_keyframe = old_keyframe;
  place.T_map_robot = T_map_robot;
  place.innovation = -1;
  return place;
}

TEST(LoopJudge, MeasuresALoopByTheErrorsOfTheWayAndOfBothScans) {
  Way way;
  LoopJudge judge = way.judge();
  EXPECT_NEAR(judge.innovation(placeAt({2, 2, kPi / 2})), 0, 1e-12);
  // Along the way: two edges, and the scans' noise along it, of both views.
  EXPECT_NEAR(judge.innovation(placeAt({2, 2.3, kPi / 2})), 0.09 / (0.02 + 2 * 0.005), 1e-9);
  // Across: the first edge's turn shows a metre on, and hangs together with the heading's.
  const double across = 0.0201 + 2 * 0.08, together = 1e-4, heading = 2e-4 + 2e-4;
  const double off_across = judge.innovation(placeAt({1.7, 2, kPi / 2}));
  EXPECT_NEAR(off_across, 0.09 * heading / (across * heading - together * together), 1e-9);
  // A turn to the left, by as much as the place lies to the left, fits better than one to the right.
  EXPECT_LT(judge.innovation(placeAt({1.7, 2, kPi / 2 + 0.02})),
            judge.innovation(placeAt({1.7, 2, kPi / 2 - 0.02})));
  EXPECT_NEAR(judge.innovation(placeAt({2, 2, kPi / 2 + 0.02 - 2 * kPi})),
              judge.innovation(placeAt({2, 2, kPi / 2 + 0.02})), 1e-9)
      << "the short way round";
}

TEST(LoopJudge, TheWayBetweenCountsNotTheWholeWay) {
  Way way;
  // From keyframe 1 on it is one edge, wherever the map begins.
  EXPECT_NEAR(way.judge().innovation(placeAt({2, 2.3, kPi / 2}, 2, 1)), 0.09 / (0.01 + 2 * 0.005), 1e-9);
}

TEST(LoopJudge, DoesNotAskForWhatWasAsked) {
  Way way;
  LoopJudge judge = way.judge();
  Hypothesis known = placeAt({0, 0, 0});
  known.innovation = 5;
  EXPECT_DOUBLE_EQ(judge.innovation(known), 5);
  EXPECT_EQ(way.asked, 0);
  judge.innovation(placeAt({2, 2.1, kPi / 2}));
  EXPECT_EQ(way.asked, 1);
}

/// Two places that are followed, both as likely by the way.
struct Rivals {
  Way way;
  std::vector<Hypothesis> all{placeAt({}), placeAt({})};
  Rivals() { all[0].innovation = all[1].innovation = 3; }
  bool firstIsBest(LoopJudge::Beyond beyond = LoopJudge::Beyond::kCounts) {
    return way.judge().isBest(all[0], all, beyond);
  }
};

// One in a thousand is exp(-6.9).
TEST(LoopJudge, APlaceIsBestWhenNoOtherIsNearlyAsGood) {
  Rivals two;
  two.all[0].says = {{2, {9, 0}}, {1, {8, 0}}};
  two.all[1].says = {{2, {5, 0}}, {1, {4.9, 0}}};
  EXPECT_TRUE(two.firstIsBest()) << "7.1 nats ahead";
  two.all[1].says[1].nats = 5.1;
  EXPECT_FALSE(two.firstIsBest()) << "6.9 nats";
  // The way between may decide.
  two.all[1].innovation = 3.4;
  EXPECT_TRUE(two.firstIsBest());
  two.all[1].innovation = 3, two.all[0].innovation = 2.6;
  EXPECT_TRUE(two.firstIsBest());
  two.all[0].innovation = 3.4;
  EXPECT_FALSE(two.firstIsBest());
  two.all.pop_back();
  EXPECT_TRUE(two.firstIsBest()) << "it is no rival of itself";
}

// By squares alone the first would be 8.75 nats ahead.
TEST(LoopJudge, WaysAreNotTrustedAsFarAsTheirCovariancesSay) {
  Rivals two;
  two.all[0].says = two.all[1].says = {{2, {9, 0}}};
  two.all[0].innovation = 0.5, two.all[1].innovation = 18;
  EXPECT_FALSE(two.firstIsBest());
  two.all[1].innovation = 40;
  EXPECT_TRUE(two.firstIsBest());
}

TEST(LoopJudge, WhatTheMapSaysNothingOfMayFitThere) {
  Rivals two;
  two.all[0].says = {{2, {9, 0}}};
  two.all[1].says = {{2, {0, 0.1}}};
  EXPECT_TRUE(two.firstIsBest()) << "8 nats at least";
  two.all[1].says = {{2, {0, 0.3}}};
  EXPECT_FALSE(two.firstIsBest());
  two.all[1].says = {};
  EXPECT_FALSE(two.firstIsBest()) << "it was not asked yet";
  two.all[1].says = {{1, {-50, 0}}};
  EXPECT_FALSE(two.firstIsBest()) << "of that keyframe the first one says nothing";
}

TEST(LoopJudge, WhatLiesBeyondTheMapIsNoRivalOfARobotThatCameFromWithin) {
  using Beyond = LoopJudge::Beyond;
  Rivals two;
  two.all[0].says = {{2, {9, 0}}, {1, {9, 0}}};
  two.all[1].says = {{2, {0, 0.9}}, {1, {0, 0.4}}};
  EXPECT_FALSE(two.firstIsBest(Beyond::kCounts));
  EXPECT_TRUE(two.firstIsBest(Beyond::kIsNoRival)) << "most of it is unknown there";
  two.all[1].says = {{2, {0, 0.9}}, {1, {6, 0.15}}};
  EXPECT_TRUE(two.firstIsBest(Beyond::kIsNoRival)) << "a little more than half";
  two.all[1].says = {{2, {0, 0.9}}, {1, {6, 0.05}}};
  EXPECT_FALSE(two.firstIsBest(Beyond::kIsNoRival)) << "a little less";
  two.all[1].says = {{2, {8, 0}}, {1, {8, 0}}};
  EXPECT_FALSE(two.firstIsBest(Beyond::kIsNoRival)) << "this one is known as well";
}

}  // namespace
}  // namespace slam::loops
