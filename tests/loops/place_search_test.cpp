#include "libslam/loops/place_search.h"

#include <gtest/gtest.h>

#include <limits>

#include "libslam/loops/loop_closer.h"
#include "tests/keyframes/drawn_map.h"
#include "tests/scanmatch/drawn_rooms.h"

namespace slam::loops {
namespace {

using core::Pose2;
using keyframes::test_maps::addKeyframe;

/// A room of which some keyframes were made; a hundred metres later the robot is there again, and odometry
/// has it elsewhere. No chain of links leads from there to the old ones.
struct Return {
  keyframes::KeyframeMap map;
  PlaceSearch search{map};
  Pose2 truth{2.2, 1.6, 0.4};
  int k;
  explicit Return(const keyframes::GraphOptions& options = {}) : map(options) {
    for (int i = 0; i < 4; ++i)
      addKeyframe(map, {1 + 0.4 * i, 1.2, 0.1 * i}, at({1 + 0.4 * i, 1.2, 0.1 * i}), 0.4 * i, i - 1);
    map.drive(100);
    k = addKeyframe(map, {2.9, 1.1, 0.5}, at(truth), 100, -1);
  }
  static lidar::Scan at(const Pose2& T_map_robot) {
    core::RandomStream chance(1, "looks");
    auto walls = scanmatch_test::rectangle(0, 0, 5, 3);
    for (const auto& box :
         {scanmatch_test::rectangle(0, 2.2, 0.9, 3), scanmatch_test::rectangle(3.8, 0, 5, 0.5)})
      walls.insert(walls.end(), box.begin(), box.end());
    return scanmatch_test::look(walls, T_map_robot, {}, chance);
  }
  std::vector<keyframes::Hypothesis> found(double piece = std::numeric_limits<double>::infinity()) {
    search.begin(k, k, k);
    pieces = 1;
    while (!search.advance(piece, [](const Pose2&) { return false; })) ++pieces;
    return search.take();
  }
  int pieces = 0;
};

TEST(PlaceSearch, FindsWhereTheRobotWasBefore) {
  Return robot;
  const auto places = robot.found();
  ASSERT_FALSE(places.empty());
  EXPECT_LT(core::distance(places[0].T_map_robot, robot.truth), 0.02);
  EXPECT_NEAR(places[0].T_map_robot.phi, robot.truth.phi, 0.01);
  EXPECT_EQ(places[0].keyframe, robot.k);
  EXPECT_EQ(places[0].begun_m, 100);
  EXPECT_FALSE(robot.search.isUnderWay());
  EXPECT_EQ(robot.pieces, 1);
  EXPECT_NEAR(robot.search.reach_m(), 1.5 + 0.03 * (100 - 1.2), 0.05);
}

TEST(PlaceSearch, InPiecesItFindsTheSame) {
  Return at_once, robot;
  const auto expected = at_once.found(), places = robot.found(1e5);
  EXPECT_GT(robot.pieces, 5);
  ASSERT_EQ(places.size(), expected.size());
  for (size_t i = 0; i < places.size(); ++i) {
    EXPECT_EQ(places[i].T_map_robot.x, expected[i].T_map_robot.x);
    EXPECT_EQ(places[i].T_map_robot.phi, expected[i].T_map_robot.phi);
    EXPECT_EQ(places[i].old_keyframe, expected[i].old_keyframe);
  }
}

TEST(PlaceSearch, DoesNotLookAtKeyframesThatComeMeanwhile) {
  Return at_once, robot;
  const auto expected = at_once.found();
  robot.search.begin(robot.k, robot.k, robot.k);
  // Where odometry has the robot, so that they would explain all that it sees there; linked with the old
  // ones.
  for (int i = 0; i < 40; ++i)
    addKeyframe(robot.map, {2.9, 1.1, 0.5}, Return::at(robot.truth), 100.1 + 0.1 * i, 3);
  robot.search.advance(std::numeric_limits<double>::infinity(), [](const Pose2&) { return false; });
  const auto places = robot.search.take();
  ASSERT_EQ(places.size(), expected.size());
  for (size_t i = 0; i < places.size(); ++i) EXPECT_EQ(places[i].T_map_robot.x, expected[i].T_map_robot.x);
}

TEST(PlaceSearch, LooksAtNoPlaceThatNothingMayBeMatchedTo) {
  Return robot;
  // The nearest ones are those that nothing is left of; without them there is a place all the same.
  for (int i = 0; i < 5; ++i) {
    const int gone = addKeyframe(robot.map, {2.9, 1.1 + 0.01 * i, 0}, {}, 50 + 15 * i, -1);
    robot.map.keyframes()[static_cast<size_t>(gone)].is_retired = true;
  }
  robot.k = addKeyframe(robot.map, {2.9, 1.1, 0.5}, Return::at(robot.truth), 200, -1);
  robot.map.keyframes()[4].is_retired = true;
  const auto places = robot.found();
  ASSERT_FALSE(places.empty());
  EXPECT_LT(core::distance(places[0].T_map_robot, robot.truth), 0.02);
}

TEST(PlaceSearch, ThatIsGivenUpFindsNothing) {
  Return robot;
  robot.search.begin(robot.k, robot.k, robot.k);
  EXPECT_TRUE(robot.search.isUnderWay());
  robot.search.advance(1, [](const Pose2&) { return false; });
  robot.search.giveUp();
  EXPECT_FALSE(robot.search.isUnderWay());
  EXPECT_TRUE(robot.search.take().empty());
}

TEST(PlaceSearch, WhatIsKnownNeedsNoMatch) {
  Return robot;
  robot.search.begin(robot.k, robot.k, robot.k);
  int asked = 0;
  EXPECT_TRUE(robot.search.advance(std::numeric_limits<double>::infinity(), [&](const Pose2& T) {
    return ++asked, core::distance(T, robot.truth) < 0.3;
  }));
  EXPECT_GT(asked, 0);
  for (const auto& place : robot.search.take())
    EXPECT_GT(core::distance(place.T_map_robot, robot.truth), 0.3);
}

/// Driven on by so much, as odometry says, too.
void driveOn(Return& robot, const Pose2& step) {
  robot.truth = robot.truth * step;
  robot.map.drive(core::hypot(step.x, step.y));
  addKeyframe(robot.map, robot.map.pose(robot.map.lastKeyframe()) * step, Return::at(robot.truth),
              robot.map.path_m(), robot.map.lastKeyframe());
  keyframes::test_maps::drawErrors(robot.map);
}

TEST(PlaceSearch, WhatItFindsIsFollowedThroughTheKeyframesThatCameMeanwhile) {
  keyframes::GraphOptions options;
  options.loop_confirmations = 3, options.loop_confirm_m = 0, options.loop_distinctness = 0;
  options.loop_innovation = 1e9, options.loop_every_m = 0.1;
  Return robot(options);
  posegraph::Edge way;
  way.from = 3, way.to = robot.k, way.T_from_to = core::between(robot.map.pose(3), robot.map.pose(robot.k));
  robot.map.keyframes().back().odometry_edge = robot.map.graph().addEdge(way);
  keyframes::test_maps::drawErrors(robot.map);
  LoopCloser loops(robot.map);
  EXPECT_FALSE(loops.closeLoops());
  driveOn(robot, {0.3, 0, 0.1});
  EXPECT_FALSE(loops.closeLoops()) << "one search at a time";
  loops.completeSearching();
  EXPECT_TRUE(loops.isFollowing());
  driveOn(robot, {0.3, 0, 0.1});
  const auto accepted = loops.closeLoops();
  ASSERT_TRUE(accepted) << "the third keyframe that fits";
  EXPECT_EQ(accepted->keyframe, robot.map.lastKeyframe());
  int searches = 0;
  for (const auto& entry : robot.map.journal()) searches += entry.event == core::JournalEvent::kSearched;
  EXPECT_EQ(searches, 1);
}

/// A robot that is searched for piece by piece: where odometry has it, and where it is.
struct Followed {
  keyframes::GraphOptions options;
  Return robot;
  LoopCloser loops{robot.map};
  explicit Followed(double work = 0.05, int confirmations = 2)
      : options(optionsWith(work, confirmations)), robot(options) {
    posegraph::Edge way;
    way.from = 3, way.to = robot.k, way.T_from_to = core::between(robot.map.pose(3), robot.map.pose(robot.k));
    // By a way that tells next to nothing, the place lies where it may.
    way.information = 1e-4 * Eigen::Matrix3d::Identity();
    robot.map.keyframes().back().odometry_edge = robot.map.graph().addEdge(way);
    keyframes::test_maps::drawErrors(robot.map);
    loops.closeLoops();
  }
  static keyframes::GraphOptions optionsWith(double work, int confirmations) {
    keyframes::GraphOptions o;
    o.loop_confirmations = confirmations, o.loop_confirm_m = 0, o.loop_distinctness = 0;
    o.loop_innovation = 1e9, o.loop_every_m = 0.1, o.loop_work = work;
    return o;
  }
};

TEST(PlaceSearch, IsFollowedAtOnceAndAcceptedWhenItWasComparedWithOthers) {
  Followed one;
  auto& [options, robot, loops] = one;
  EXPECT_FALSE(loops.isWhereExpected());
  for (int scan = 0; scan < 10000 && !loops.isFollowing(); ++scan) ASSERT_FALSE(loops.continueSearching());
  ASSERT_TRUE(loops.isFollowing()) << "the search for rivals is not done";
  for (int i = 0; i < 3; ++i) {
    driveOn(robot, {0.1, 0, 0.05});
    EXPECT_FALSE(loops.closeLoops()) << "confirmed often enough, but a rival may come";
  }
  EXPECT_TRUE(loops.isWhereExpected());
  const auto accepted = loops.completeSearching();
  ASSERT_TRUE(accepted);
  EXPECT_EQ(accepted->keyframe, robot.map.lastKeyframe());
  EXPECT_FALSE(loops.isWhereExpected()) << "nothing is followed any longer";
}

TEST(PlaceSearch, APlaceThatTheWayRulesOutIsNotWhereTheRobotIsExpected) {
  Followed one;
  auto& [options, robot, loops] = one;
  const auto measureFirmly = [&map = robot.map](int k, int before) {
    posegraph::Edge firm;
    firm.from = before, firm.to = k, firm.T_from_to = core::between(map.pose(before), map.pose(k));
    firm.information = 1e6 * Eigen::Matrix3d::Identity();
    map.keyframes()[static_cast<size_t>(k)].odometry_edge = map.graph().addEdge(firm);
    keyframes::test_maps::drawErrors(map);
  };
  for (int k = 1; k <= robot.k; ++k) measureFirmly(k, k - 1);
  while (!loops.isFollowing()) loops.continueSearching();
  for (int i = 0; i < 2; ++i) {
    driveOn(robot, {0.1, 0, 0.05});
    measureFirmly(robot.map.lastKeyframe(), robot.map.lastKeyframe() - 1);
    loops.closeLoops();
  }
  ASSERT_TRUE(loops.isFollowing());
  EXPECT_FALSE(loops.isWhereExpected());
}

TEST(PlaceSearch, InTheEndKeyframesThatLieFarApartConfirmAPlaceToo) {
  keyframes::GraphOptions options = Followed::optionsWith(20, 3);
  options.loop_path_m = 0.2;
  Return robot(options);
  for (int i = 0; i < 3; ++i) driveOn(robot, {0.3, 0, 0.1});
  for (int k = robot.k; k <= robot.map.lastKeyframe(); ++k) {
    posegraph::Edge way;
    way.from = k - 1, way.to = k, way.T_from_to = core::between(robot.map.pose(k - 1), robot.map.pose(k));
    way.information = 1e-4 * Eigen::Matrix3d::Identity();
    robot.map.keyframes()[static_cast<size_t>(k)].odometry_edge = robot.map.graph().addEdge(way);
  }
  keyframes::test_maps::drawErrors(robot.map);
  LoopCloser loops(robot.map);
  int moved = 0;
  loops.searchRemainingLoops(robot.k, [&] { ++moved; });
  EXPECT_GT(moved, 0);
  EXPECT_LT(core::distance(robot.map.pose(robot.map.lastKeyframe()), robot.truth), 0.05);
}

TEST(PlaceSearch, AsksForAsMuchAsTheMapAroundExplains) {
  keyframes::GraphOptions options;
  options.loop_score = 0.999;
  Return strict(options), used_to_little(options);
  EXPECT_TRUE(strict.found().empty());
  for (int i = 0; i < 10; ++i) used_to_little.map.noteExplained(0.5);
  EXPECT_FALSE(used_to_little.found().empty());
}

TEST(PlaceSearch, OfWhatTheMapAroundExplainsTheMeanCounts) {
  keyframes::KeyframeMap map{keyframes::GraphOptions{}};
  EXPECT_DOUBLE_EQ(map.adapted(0.6), 0.6) << "nothing is known yet";
  map.noteExplained(0.9);
  EXPECT_DOUBLE_EQ(map.adapted(0.6), 0.6) << "never more";
  map.noteExplained(0.1), map.noteExplained(0.05);
  EXPECT_DOUBLE_EQ(map.adapted(0.6), 0.6 * 0.35 / 0.7);
}

TEST(PlaceSearch, TakesTheFewerScansTheFartherTheseLieApart) {
  const keyframes::GraphOptions options;
  const auto scansNeeded = [](double step_m) {
    Followed one(1e-3, 1);
    int scans = 1;
    for (; !one.loops.continueSearching() && scans < 10000; ++scans) one.robot.map.drive(step_m);
    return scans;
  };
  const int near = scansNeeded(0.1), far = scansNeeded(10 * options.keyframe_distance_m);
  EXPECT_GT(near, 20);
  EXPECT_EQ(scansNeeded(0.2), near) << "a keyframe in more than one scan";
  EXPECT_LT(far, near / 5);
}

}  // namespace
}  // namespace slam::loops
