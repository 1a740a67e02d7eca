// What accepting a loop does to a map, by hand: maps in a row, with one edge for a loop.
#include <gtest/gtest.h>

#include "libslam/keyframes/search.h"
#include "libslam/loops/loop_closer.h"
#include "libslam/posegraph/optimize.h"
#include "tests/keyframes/drawn_map.h"

namespace slam::loops {
namespace {

using core::kPi;
using core::Pose2;
using keyframes::test_maps::addKeyframe;
using keyframes::test_maps::drawErrors;
using keyframes::test_maps::roundRoom;

keyframes::GraphOptions gateAt60() {
  keyframes::GraphOptions options;
  options.loop_innovation = 60;
  return options;
}

/// Keyframes in a row, half a metre apart by odometry of 10 cm and 10 mrad.
struct Driven {
  keyframes::KeyframeMap map;
  LoopCloser loops{map};
  explicit Driven(int count, const keyframes::GraphOptions& options = gateAt60()) : map(options) {
    for (int k = 0; k < count; ++k) add();
  }
  int add() {
    const int k = map.size();
    map.drive(k == 0 ? 0 : 10);
    addKeyframe(map, {0.5 * k, 0, 0}, roundRoom(5), map.path_m(), -1);
    if (k == 0) return k;
    posegraph::Edge edge;
    edge.from = k - 1, edge.to = k, edge.T_from_to = {0.5, 0, 0};
    edge.information = Eigen::Vector3d(100, 100, 1e4).asDiagonal();
    map.keyframes().back().odometry_edge = map.graph().addEdge(edge);
    map.link(k - 1, k);
    drawErrors(map);
    return k;
  }
  std::vector<core::JournalEvent> events() const {
    std::vector<core::JournalEvent> result;
    for (const auto& entry : map.journal()) result.push_back(entry.event);
    return result;
  }
};

/// Keyframe `to` lies there, seen from `from`.
keyframes::Hypothesis loopTo(const keyframes::KeyframeMap& map, int from, int to, const Pose2& T_from_to,
                             const Eigen::Vector3d& information) {
  posegraph::Edge edge;
  edge.from = from, edge.to = to, edge.T_from_to = T_from_to;
  edge.information = information.asDiagonal();
  edge.kind = posegraph::EdgeKind::kLoop;
  keyframes::Hypothesis loop{};
  loop.keyframe = to, loop.old_keyframe = from;
  loop.T_map_robot = map.pose(from) * T_from_to;
  loop.innovation = -1;
  loop.edges = {edge};
  return loop;
}

// Four edges of 0.01 square metres, and a loop of 0.04 that has the last keyframe 0.2 m nearer: half of it.
TEST(ClosingLoops, SpreadsTheErrorOverTheWay) {
  Driven row(5);
  const auto loop = loopTo(row.map, 0, 4, {1.8, 0, 0}, {25, 25, 2500});
  const auto accepted = row.loops.accept(loop);
  ASSERT_TRUE(accepted);
  EXPECT_EQ(accepted->old_keyframe, 0);
  EXPECT_EQ(accepted->keyframe, 4);
  EXPECT_FALSE(accepted->joins);
  EXPECT_TRUE(row.loops.isClosing());
  for (int k = 0; k < 5; ++k) EXPECT_DOUBLE_EQ(row.map.pose(k).x, 0.5 * k) << "not moved yet";
  EXPECT_TRUE(row.loops.completeClosing());
  EXPECT_FALSE(row.loops.isClosing());
  for (int k = 0; k < 5; ++k) {
    EXPECT_NEAR(row.map.pose(k).x, 0.475 * k, 1e-6) << k;
    EXPECT_NEAR(row.map.pose(k).y, 0, 1e-9);
  }
  EXPECT_EQ(row.map.revision(), 1);
  EXPECT_FALSE(row.loops.completeClosing()) << "there is nothing left";
}

/// In how many pieces the poses of this graph are found, as LoopCloser asks for them.
int piecesToFind(const posegraph::PoseGraph& graph, double piece) {
  posegraph::OptimizeOptions options;
  options.robust = "none", options.tolerance = 0.05;
  posegraph::OptimizeInPieces work(graph, options);
  for (int pieces = 1;; ++pieces)
    if (double left = piece; work.advance(left)) return pieces;
}

// A piece may end with much of its work left, where what comes next is too large for that.
TEST(ClosingLoops, MovesNothingBeforeAllIsFound) {
  for (const double work : {0.005, 0.01, 0.015, 0.02, 0.025, 0.03, 0.05}) {
    keyframes::GraphOptions options;
    options.loop_work = work;
    Driven row(60, options);
    ASSERT_TRUE(row.loops.accept(loopTo(row.map, 0, 59, {29, 0, 0}, {25, 25, 2500})));
    const int needed = piecesToFind(row.map.graph(), work * keyframes::kWorkPerUnit);
    int pieces = 1;
    for (; !row.loops.continueClosing(true); ++pieces) ASSERT_LT(pieces, 1000);
    EXPECT_GE(pieces, needed) << work;
  }
}

TEST(ClosingLoops, LearnsHowSureTheMapIsWithThePoses) {
  keyframes::GraphOptions options;
  options.loop_work = 0.02;
  Driven row(5, options);
  ASSERT_TRUE(row.loops.accept(loopTo(row.map, 0, 4, {1.8, 0, 0}, {25, 25, 2500})));
  const Eigen::Matrix3d before = row.map.errorsOf(4).covariance();
  int pieces = 1;
  for (; !row.loops.continueClosing(true); ++pieces) {
    ASSERT_LT(pieces, 1000);
    EXPECT_EQ(row.map.errorsOf(4).covariance(), before);
    if (pieces == 2) row.add();
  }
  EXPECT_GT(pieces, 5) << "a flow and four pieces of draws";
  // Four edges of 0.01 square metres; the loop counts as 62.5 to one over that. Of 64 draws.
  const Eigen::Matrix3d of_last = row.map.errorsOf(4).covariance();
  EXPECT_NEAR(of_last(0, 0), 1 / (25 + 62.5), 0.4 / (25 + 62.5));
  EXPECT_EQ(row.map.errorsOf(0).covariance().norm(), 0);
  const auto step = wayCovariance(row.map.errorsOf(4), row.map.pose(4), row.map.errorsOf(5), row.map.pose(5));
  EXPECT_NEAR(step(0, 0), 0.01 / 16, 0.3 * 0.01 / 16) << "came since, and errs by as much more as before";
  EXPECT_FALSE(row.loops.isClosing());
}

// Whoever does the work, and however it is divided.
TEST(ClosingLoops, AThreadMovesTheMapAtTheSameScanToTheSamePlace) {
  for (const double work : {0.005, 0.05, 1.0}) {
    keyframes::GraphOptions options;
    options.loop_work = work;
    Driven here(60, options), beside(60, options);
    beside.loops.workBy(LoopCloser::Where::kByThread);
    for (Driven* row : {&here, &beside})
      ASSERT_TRUE(row->loops.accept(loopTo(row->map, 0, 59, {29, 0.1, 0}, {25, 25, 2500})));
    for (int pieces = 1; here.loops.isClosing(); ++pieces) {
      ASSERT_LT(pieces, 1000);
      EXPECT_EQ(here.loops.continueClosing(true), beside.loops.continueClosing(true)) << pieces;
      EXPECT_EQ(here.map.revision(), beside.map.revision()) << pieces;
    }
    EXPECT_FALSE(beside.loops.isClosing());
    for (int k = 0; k < 60; ++k) {
      EXPECT_EQ(here.map.pose(k).x, beside.map.pose(k).x);
      EXPECT_EQ(here.map.errorsOf(k).covariance(), beside.map.errorsOf(k).covariance());
    }
    EXPECT_NE(here.map.pose(59).x, 29.5);
    EXPECT_EQ(here.loops.threadSeconds(), 0);
    EXPECT_GT(beside.loops.threadSeconds(), 0);
  }
}

TEST(ClosingLoops, JoinsTheEndsOnlyWhenThePosesFollow) {
  Driven row(5);
  ASSERT_TRUE(row.loops.accept(loopTo(row.map, 0, 4, {1.8, 0, 0}, {25, 25, 2500})));
  EXPECT_DOUBLE_EQ(row.map.pathTo(4)[0], 40);
  EXPECT_EQ(row.map.keyframesAround(0, {0, 0}, 1.95, 9).size(), 4U) << "four half metres to the last one";
  EXPECT_FALSE(row.loops.continueClosing(false)) << "the map may not move yet";
  EXPECT_TRUE(row.loops.isClosing());
  EXPECT_TRUE(row.loops.continueClosing(true));
  EXPECT_FALSE(row.loops.isClosing());
  EXPECT_DOUBLE_EQ(row.map.pathTo(4)[0], 0);
  EXPECT_DOUBLE_EQ(row.map.pathTo(4)[1], 10);
  EXPECT_EQ(row.map.keyframesAround(0, {0, 0}, 1.91, 9).size(), 5U) << "1.9 m by the loop's link";
  const auto events = row.events();
  ASSERT_EQ(events.size(), 3U);
  EXPECT_EQ(events[0], core::JournalEvent::kConfirmed);
  EXPECT_EQ(events[1], core::JournalEvent::kAccepted);
  EXPECT_EQ(row.map.journal()[1].value, 40) << "the way that it closes";
  EXPECT_EQ(events[2], core::JournalEvent::kOptimised);
}

TEST(ClosingLoops, KeyframesThatComeMeanwhileStayWithTheOneBefore) {
  Driven row(5);
  ASSERT_TRUE(row.loops.accept(loopTo(row.map, 0, 4, {1.8, 0.3, 0.1}, {1e6, 1e6, 1e6})));
  row.add();
  row.map.graph().setPose(5, {2.2, 0.4, 0.5});
  row.add();
  const Pose2 before = core::between(row.map.pose(4), row.map.pose(5)),
              next = core::between(row.map.pose(5), row.map.pose(6));
  EXPECT_TRUE(row.loops.completeClosing());
  EXPECT_NEAR(row.map.pose(4).x, 1.8, 1e-3);
  EXPECT_NEAR(row.map.pose(4).y, 0.3, 1e-3);
  const Pose2 after = core::between(row.map.pose(4), row.map.pose(5)),
              later = core::between(row.map.pose(5), row.map.pose(6));
  EXPECT_LT(core::distance(before, after), 1e-9);
  EXPECT_NEAR(before.phi, after.phi, 1e-9);
  EXPECT_LT(core::distance(next, later), 1e-9);
}

// Three metres off, where the way between has 10 cm for each of four edges.
TEST(ClosingLoops, RejectsWhatTheWayRulesOut) {
  Driven row(5);
  const size_t edges = row.map.graph().edges().size();
  EXPECT_FALSE(row.loops.accept(loopTo(row.map, 0, 4, {2, 3, 0}, {100, 100, 1e4})));
  EXPECT_FALSE(row.loops.isClosing());
  EXPECT_EQ(row.map.graph().edges().size(), edges);
  ASSERT_EQ(row.events().back(), core::JournalEvent::kRejected);
  EXPECT_GT(row.map.journal().back().value, row.map.options().loop_innovation);
  // Once it is closed, the next one is judged by what is known then.
  ASSERT_TRUE(row.loops.accept(loopTo(row.map, 0, 4, {2, 0, 0}, {1e4, 1e4, 1e6})));
  row.loops.completeClosing();
  EXPECT_FALSE(row.loops.accept(loopTo(row.map, 0, 4, {2, 1, 0}, {1e4, 1e4, 1e6})))
      << "a metre was possible before";
}

// A path may be surer of itself than it should be.
TEST(ClosingLoops, AcceptWhatTheWayHardlyAllowsForOnceManyScansConfirmIt) {
  Driven row(5);
  auto loop = loopTo(row.map, 0, 4, {2, 1.8, 0}, {1e4, 1e4, 1e6});
  loop.confirmations = row.map.options().loop_confirmations;
  EXPECT_FALSE(row.loops.accept(loop));
  const double off = row.map.journal().back().value, gate = row.map.options().loop_innovation;
  ASSERT_GT(off, gate);
  ASSERT_LT(off, 2 * gate);
  const double usual = 7.8;  // 95 of 100 right loops lie within it
  loop.confirmations = static_cast<int>(row.map.options().loop_confirmations * off / usual);
  EXPECT_FALSE(row.loops.accept(loop)) << "one scan too few";
  ++loop.confirmations;
  EXPECT_TRUE(row.loops.accept(loop));
  // Of what lies farther none are enough.
  Driven other(5);
  auto far = loopTo(other.map, 0, 4, {2, 3, 0}, {1e4, 1e4, 1e6});
  far.confirmations = 1000;
  EXPECT_FALSE(other.loops.accept(far));
}

// Each keyframe lies 10 m of way from the one before, so that those before it are of an earlier pass.
TEST(ClosingLoops, WhereAnEarlierPassExplainsTheScansTheWayHasToSayMore) {
  for (const bool is_known : {true, false}) {
    Driven row(5);
    if (!is_known)
      for (int k = 0; k < 5; ++k) row.map.keyframes()[static_cast<size_t>(k)].path_m = 0.5 * k;
    auto loop = loopTo(row.map, 0, 4, {2, 1.2, 0}, {1e4, 1e4, 1e6});
    loop.says = {{3, {9, 0}}, {4, {9, 0}}};
    EXPECT_EQ(row.loops.accept(loop).has_value(), !is_known);
    if (!is_known) continue;
    EXPECT_LT(row.map.journal().back().value, row.map.options().loop_innovation);
    // A likely one is none the less.
    loop = loopTo(row.map, 0, 4, {2, 0.3, 0}, {1e4, 1e4, 1e6});
    loop.says = {{3, {9, 0}}, {4, {9, 0}}};
    EXPECT_TRUE(row.loops.accept(loop));
  }
}

// A shift of the map that one edge makes impossible, four edges allow for.
TEST(ClosingLoops, WhatClaimsTheSameAsAnImpossibleOneIsWrongToo) {
  const auto shifted = [](const Driven& row, int to, double aside_m) {
    return loopTo(row.map, 0, to, {0.5 * to, aside_m, 0}, {1e4, 1e4, 1e6});
  };
  Driven alone(5);
  EXPECT_TRUE(alone.loops.accept(shifted(alone, 4, 1.55)));
  Driven row(5);
  EXPECT_FALSE(row.loops.accept(shifted(row, 1, 1.55)));
  EXPECT_GT(row.map.journal().back().value, 2 * row.map.options().loop_innovation);
  EXPECT_FALSE(row.loops.accept(shifted(row, 4, 1.55)));
  EXPECT_TRUE(row.loops.accept(shifted(row, 4, -1.55))) << "that is another claim";
}

/// A row, and another part beside it that was laid out elsewhere.
struct TwoParts : Driven {
  TwoParts() : Driven(3) {
    map.beginPart(3);
    for (int k = 0; k < 3; ++k)
      addKeyframe(map, Pose2{50, 20, 2} * Pose2{0.4 * k, 0, 0}, roundRoom(5), 100 + k,
                  k == 0 ? -1 : map.lastKeyframe());
    map.keyframes()[3].odometry_edge =
        map.keyframes()[4].odometry_edge;  // reached from nowhere that is known
  }
};

TEST(ClosingLoops, APartComesToTheMapAsItIs) {
  TwoParts two;
  const Pose2 T_1_4{0.3, 1, kPi / 2};
  const auto accepted = two.loops.accept(loopTo(two.map, 1, 4, T_1_4, {1e4, 1e4, 1e4}));
  ASSERT_TRUE(accepted);
  EXPECT_TRUE(accepted->joins);
  for (int k = 0; k < 3; ++k) EXPECT_DOUBLE_EQ(two.map.pose(k).x, 0.5 * k) << "where the origin is stays";
  // Keyframe 4 at (0.8, 1), looking along y; the others 40 cm behind and before it.
  for (int k = 3; k < 6; ++k) {
    EXPECT_NEAR(two.map.pose(k).x, 0.8, 1e-9) << k;
    EXPECT_NEAR(two.map.pose(k).y, 1 + 0.4 * (k - 4), 1e-9) << k;
    EXPECT_NEAR(two.map.pose(k).phi, kPi / 2, 1e-9) << k;
    EXPECT_FALSE(two.map.isCutOff(k));
  }
  EXPECT_EQ(two.events().back(), core::JournalEvent::kRecovered) << "the robot was cut off";
  EXPECT_EQ(two.map.keyframesAround(0, {0, 0}, 10, 10).size(), 6U) << "linked at once";
}

TEST(ClosingLoops, TheOriginStaysWhicheverPartTheLoopWasFoundFrom) {
  TwoParts two;
  // Found from keyframe 1, which is in the map's first part, at keyframe 4 of the other one.
  const Pose2 T_1_4{0.3, 1, kPi / 2};
  const auto accepted = two.loops.accept(loopTo(two.map, 4, 1, core::inverse(T_1_4), {1e4, 1e4, 1e4}));
  ASSERT_TRUE(accepted);
  EXPECT_TRUE(accepted->joins);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(two.map.pose(k).x, 0.5 * k, 1e-12);
  for (int k = 3; k < 6; ++k) {
    EXPECT_NEAR(two.map.pose(k).x, 0.8, 1e-9) << k;
    EXPECT_NEAR(two.map.pose(k).y, 1 + 0.4 * (k - 4), 1e-9) << k;
  }
}

TEST(ClosingLoops, WhatIsLeftIsSolvedOnceOnAWayThatIsLongEnough) {
  Driven shorter(3), row(5);
  EXPECT_FALSE(shorter.loops.closeRest()) << "20 m: each place was passed once";
  // A tie that is no loop says that the last keyframe is 0.2 m nearer, as the odometry of the way in a whole.
  row.map.tie(4, {0}, {1.8, 0, 0}, Eigen::Vector3d(25, 25, 2500).asDiagonal(), 1);
  EXPECT_TRUE(row.loops.closeRest());
  EXPECT_NEAR(row.map.pose(4).x, 1.9, 1e-6);
  EXPECT_FALSE(row.loops.closeRest()) << "nothing was measured since";
  row.add();
  EXPECT_TRUE(row.loops.closeRest());
}

}  // namespace
}  // namespace slam::loops
