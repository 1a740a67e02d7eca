#include "libslam/keyframes/keyframe_map.h"

#include <gtest/gtest.h>

#include "libslam/keyframes/search.h"
#include "tests/keyframes/drawn_map.h"
#include "tests/scanmatch/drawn_rooms.h"

namespace slam::keyframes {
namespace {

using core::kPi;
using core::Pose2;
using test_maps::addKeyframe;
using test_maps::addRow;
using test_maps::roundRoom;
using Numbers = std::vector<int>;

TEST(KeyframeMap, PartsGetOneComponentWhenTheyAreJoined) {
  KeyframeMap map{GraphOptions{}};
  addRow(map, 3);
  EXPECT_FALSE(map.isCutOff(2));
  map.beginPart(3);
  addRow(map, 2);
  map.beginPart(5);
  addRow(map, 1);
  EXPECT_EQ(map.componentOf(2), 0);
  EXPECT_EQ(map.componentOf(4), 3);
  EXPECT_EQ(map.componentOf(5), 5);
  EXPECT_TRUE(map.isCutOff(3));
  EXPECT_EQ(map.gapsBetween(0, 5), 2);
  EXPECT_EQ(map.gapsBetween(2, 3), 1);
  EXPECT_EQ(map.gapsBetween(3, 4), 0) << "the part begins with keyframe 3";
  EXPECT_EQ(map.gapsBetween(3, 5), 1);
  map.joinComponents(5, 3);
  EXPECT_EQ(map.componentOf(5), map.componentOf(3));
  EXPECT_TRUE(map.isCutOff(5));
  EXPECT_EQ(map.componentOf(0), 0);
  map.joinComponents(3, 0);
  for (int k = 0; k < map.size(); ++k) EXPECT_FALSE(map.isCutOff(k)) << k;
}

TEST(KeyframeMap, FindsKeyframesByPlace) {
  GraphOptions options;
  options.map_radius_m = 3.5, options.map_keyframes = 5;
  KeyframeMap map(options);
  addRow(map, 20);
  EXPECT_EQ(map.keyframesWithin({4.1, 0}, 1.1), (Numbers{4, 5, 3}));
  map.keyframes()[4].unsure = true, map.keyframes()[6].is_retired = true;
  EXPECT_EQ(map.keyframesWithin({4.1, 0}, 2.2), (Numbers{5, 3, 2}));
  // Another part lies over the first one, until its place is known.
  map.beginPart(15);
  for (int k = 15; k < 20; ++k) map.graph().setPose(k, {k - 12.0, 0.1, 0});
  EXPECT_EQ(map.keyframesNear({4.1, 0}, 0, 2), (Numbers{5, 3}));
  EXPECT_EQ(map.keyframesNear({4.1, 0}, 15, 2), (Numbers{16, 17}));
  EXPECT_EQ(map.keyframesNear({4.1, 0}, 15, 9), (Numbers{16, 17, 15, 18, 19})) << "all within the radius";
  EXPECT_EQ(map.keyframesAtPlace(1), (Numbers{1, 0, 2, 3, 5})) << "of its part, so many";
  EXPECT_EQ(map.keyframesAtPlace(19), (Numbers{19, 18, 17, 16, 15}));
}

TEST(KeyframeMap, KeyframesAroundHangTogetherAndMayBeMatchedTo) {
  KeyframeMap map{GraphOptions{}};
  addRow(map, 4);
  addKeyframe(map, {1, 0.5, 0}, roundRoom(5), 100, -1);  // beside the others, and linked with none
  map.keyframes()[2].unsure = true;
  EXPECT_EQ(map.keyframesAround(0, {0, 0}, 10, 10), (Numbers{0, 1, 3})) << "chains lead through it";
  EXPECT_EQ(map.keyframesAround(4, {0, 0}, 10, 10), (Numbers{4}));
}

TEST(KeyframeMap, KnowsWhatAKeyframeWasReachedFrom) {
  KeyframeMap map{GraphOptions{}};
  addRow(map, 3);
  map.tie(2, {0}, map.pose(2), Eigen::Matrix3d::Identity(), 1);  // an edge that is no odometry
  addKeyframe(map, {1, 1, 0}, roundRoom(5), 4, 1);
  EXPECT_EQ(map.keyframeBefore(0), -1);
  EXPECT_EQ(map.keyframeBefore(2), 1);
  EXPECT_EQ(map.keyframeBefore(3), 1);
}

TEST(KeyframeMap, TheJournalSpeaksOfScans) {
  KeyframeMap map{GraphOptions{}};
  addRow(map, 3);
  map.nextScan(), map.nextScan();
  map.note(core::JournalEvent::kFound, 0.7, 2, "why");
  map.note(core::JournalEvent::kOptimised, 5);
  ASSERT_EQ(map.journal().size(), 2U);
  const auto& found = map.journal()[0];
  EXPECT_EQ(found.scan, 2);
  EXPECT_EQ(found.other_scan, 20) << "of the keyframe, not its number";
  EXPECT_EQ(found.value, 0.7);
  EXPECT_EQ(found.detail, "why");
  EXPECT_EQ(map.journal()[1].other_scan, -1);
}

TEST(KeyframeMap, ClosuresShortenThePathUntilTheyAreTakenBack) {
  KeyframeMap map{GraphOptions{}};
  addRow(map, 11);
  map.addClosure(1, 9);
  EXPECT_DOUBLE_EQ(map.pathTo(10)[0], 2);
  map.removeClosure(2, 9);
  EXPECT_DOUBLE_EQ(map.pathTo(10)[0], 2) << "that one is another";
  map.removeClosure(1, 9);
  EXPECT_DOUBLE_EQ(map.pathTo(10)[0], 10);
}

TEST(KeyframeMap, ThePlaceAroundIsWhatItsKeyframesSawAsTheyLie) {
  KeyframeMap map{GraphOptions{}};
  addRow(map, 2);
  map.graph().setPose(1, {10, -3, kPi / 2});
  const auto place = map.placeAround({1});
  ASSERT_GT(place.size(), 100U);
  for (const auto& p : place) EXPECT_NEAR(core::distance(p, {10, -3}), 5, 1e-5);
  EXPECT_EQ(map.placeAround({0, 1}).size(), 2 * place.size());
}

/// A corridor along the map's y of 3 m, and a robot that looks along it, its lidar aside.
struct InCorridor {
  KeyframeMap map{GraphOptions{}};
  Pose2 T_map_robot{1.3, 0, kPi / 2};
  InCorridor() {
    const std::vector<scanmatch_test::Wall> walls = {{{0, -30}, {0, 30}}, {{3, -30}, {3, 30}}};
    scanmatch_test::Lidar lidar;
    lidar.noise_m = 0, lidar.T_robot_lidar = {0.3, 0.1, 0.2};
    core::RandomStream unused(1, "unused");
    for (int k = 0; k < 6; ++k) {
      const Pose2 T{T_map_robot.x, 0.1 * k, T_map_robot.phi};
      addKeyframe(map, T, look(walls, T, lidar, unused), 0.1 * k, k - 1);
    }
  }
};

TEST(KeyframeMap, LoopEdgesLeadFromTheNearestAndSayNothingAlongACorridor) {
  InCorridor in;
  const Pose2 T_matched{in.T_map_robot.x, 0.52, in.T_map_robot.phi};
  const Numbers around = {4, 3, 2, 1, 0};
  const LevelMaps& maps = in.map.mapOf(around, core::position(T_matched));
  std::vector<posegraph::Edge> edges, of_one;
  in.map.addLoopEdges(edges, around, 5, T_matched, maps.fine);
  ASSERT_EQ(edges.size(), static_cast<size_t>(kConfirmEdges));
  for (size_t i = 0; i < edges.size(); ++i) {
    EXPECT_EQ(edges[i].from, around[i]);
    EXPECT_EQ(edges[i].to, 5);
    EXPECT_EQ(edges[i].kind, posegraph::EdgeKind::kLoop);
    // Where the match has it, not where the keyframe is: ahead of the others, which look the same way.
    EXPECT_NEAR(edges[i].T_from_to.x, 0.52 - 0.1 * around[i], 1e-9);
    EXPECT_NEAR(edges[i].T_from_to.y, 0, 1e-9);
    // Along the robot's x nothing is known, across all.
    EXPECT_LT(edges[i].information(0, 0), 1e-2 * edges[i].information(1, 1));
  }
  // One partner does not get the others' share.
  in.map.addLoopEdges(of_one, {4}, 5, T_matched, maps.fine);
  ASSERT_EQ(of_one.size(), 1U);
  EXPECT_LT((of_one[0].information - edges[0].information).norm(), 1e-9 * edges[0].information.norm());
}

TEST(KeyframeMap, TiesShareWhatAMatchTellsInTheBodysAxes) {
  InCorridor in;
  const Eigen::Matrix3d information = Eigen::Vector3d(400, 1, 900).asDiagonal();  // map frame: x is across
  const size_t before = in.map.graph().edges().size();
  in.map.tie(5, {1, 3}, {1.3, 0.6, kPi / 2}, information, 2);
  const auto& edges = in.map.graph().edges();
  ASSERT_EQ(edges.size(), before + 2);
  EXPECT_EQ(edges.back().from, 3);
  EXPECT_EQ(edges.back().to, 5);
  EXPECT_NEAR(edges.back().T_from_to.x, 0.3, 1e-9);
  EXPECT_NEAR(edges.back().information(0, 0), 0.5, 1e-6);
  EXPECT_NEAR(edges.back().information(1, 1), 200, 1e-6);
  EXPECT_NEAR(edges.back().information(2, 2), 450, 1e-6);
  // The links are as long as the keyframes are apart: 0.4 m, where the chain from 1 to 5 was as long.
  EXPECT_EQ(in.map.keyframesAround(1, {1.3, 0}, 0.41, 0.9).size(), 6U);
  in.map.graph().setPose(5, {1.3, 0.9, kPi / 2});
  in.map.link(0, 5);
  EXPECT_EQ(in.map.keyframesAround(5, {1.3, 0.9}, 0.89, 0.1), (Numbers{5}));
}

TEST(KeyframeMap, SettlingTakesLengthsAnew) {
  KeyframeMap map{GraphOptions{}};
  addRow(map, 3);
  map.settle({0, {{0, 0, 0}, {1, 0, 0}, {1, 4, 0}}, {}});
  EXPECT_EQ(map.revision(), 1);
  EXPECT_EQ(map.keyframesAround(1, {1, 0}, 3.9, 9).size(), 2U);
  EXPECT_EQ(map.keyframesAround(1, {1, 0}, 4.1, 9).size(), 3U);
}

/// A furnished room of 8 x 5 m, one keyframe in it and a scan from elsewhere.
struct InRoom {
  std::vector<scanmatch_test::Wall> walls = scanmatch_test::rectangle(0, 0, 8, 5);
  KeyframeMap map{GraphOptions{}};
  lidar::Scan at(const Pose2& T_map_robot) const {
    scanmatch_test::Lidar lidar;
    lidar.noise_m = 0, lidar.fov_rad = 1.5 * kPi, lidar.beams = 271, lidar.T_robot_lidar = {0.2, -0.1, -0.3};
    core::RandomStream unused(1, "unused");
    return look(walls, T_map_robot, lidar, unused);
  }
  InRoom() {
    const auto box = scanmatch_test::rectangle(5, 3.5, 5.8, 4);
    walls.insert(walls.end(), box.begin(), box.end());
    addKeyframe(map, {2, 2, 0.3}, at({2, 2, 0.3}), 0, -1);
    addKeyframe(map, {2.5, 1.7, 1.2}, at({2.5, 1.7, 1.2}), 0.6, 0);
  }
};

TEST(KeyframeMap, AFreeMatchFindsThePoseAndNeedsNoPrior) {
  const InRoom in;
  const Pose2 truth{3, 2.2, -0.4};
  const auto points = pointsOf(in.at(truth), in.map.options());
  for (const auto& [off, coarse] :
       {std::pair{Pose2{0.1, -0.1, 0.05}, false}, {Pose2{0.35, 0.3, 0.12}, true}}) {
    const auto matched = in.map.matchFreely(points, {0, 1}, truth * off, coarse);
    EXPECT_LT(core::distance(matched.T_map_robot, truth), 0.01);
    EXPECT_NEAR(matched.T_map_robot.phi, truth.phi, 0.003);
    EXPECT_GT(matched.score, 0.6);
  }
}

// There and back along a corridor, with a lidar that looks ahead: what the robot sees on its way back was
// seen from farther on.
TEST(KeyframeMap, OfKeyframesThoseCountAsNearThatSeeTheSame) {
  InRoom in;
  in.walls = scanmatch_test::rectangle(-20, -1, 40, 1);
  KeyframeMap map{GraphOptions{}};
  const int count = 21;
  for (int k = 0; k < count; ++k) addKeyframe(map, {k - 10.0, 0, 0}, in.at({k - 10.0, 0, 0}), 1.0 * k, k - 1);
  const Pose2 T_back{0.2, 0.1, kPi};
  const int back = addKeyframe(map, T_back, in.at(T_back), 31, 10);
  const auto alike = map.keyframesLookingAlike(back, T_back, 25, 8, 5),
             near = map.keyframesAround(back, {0.2, 0.1}, 25, 8);
  ASSERT_EQ(alike.size(), 5U);
  EXPECT_EQ(alike.front(), back);
  EXPECT_EQ(near[1], 10);
  const double seen_m = -2 * map.keyframe(0).view_centre.x;  // it looks so far past where the other one does
  ASSERT_LT(seen_m, -2);
  for (size_t i = 1; i < alike.size(); ++i) EXPECT_NEAR(map.pose(alike[i]).x, seen_m / 2, 2.2) << i;
  // However many are asked for: those within the radius.
  EXPECT_EQ(map.keyframesLookingAlike(back, T_back, 25, 2.1, 50).size(), 5U);
}

TEST(KeyframeMap, AMapIsFilledAnewForEveryQuestion) {
  const InRoom in;
  const auto points = pointsOf(in.at({2, 2, 0.3}), in.map.options());
  const auto score = [&](const Numbers& keyframes) {
    return surfelScore(points, in.map.mapOf(keyframes, {2, 2}).fine, {2, 2, 0.3}, 3, 1);
  };
  EXPECT_GT(score({0}), 0.5) << "far points stand alone in their cells";
  EXPECT_DOUBLE_EQ(score({}), 0);
}

// Points stay sorted from one map to the next.
TEST(KeyframeMap, AMapHasKeyframesWhereTheyLieNowAndWhatTheyStillSee) {
  InRoom in;
  const auto points = pointsOf(in.at({2, 2, 0.3}), in.map.options());
  const auto scoreAt = [&](const Pose2& T) {
    return surfelScore(points, in.map.mapOf({0}, {2, 2}).fine, T, 3, 1);
  };
  const double before = scoreAt({2, 2, 0.3});
  const Pose2 moved{2.4, 1.7, 0.3};
  in.map.graph().setPose(0, moved);
  EXPECT_LT(scoreAt({2, 2, 0.3}), 0.5 * before);
  EXPECT_NEAR(scoreAt(moved), before, 0.1);
  auto& known = in.map.keyframes()[0].points;
  known.resize(known.size() / 2);
  in.map.countRevision();
  EXPECT_NEAR(scoreAt(moved), before / 2, 0.1);
  // Keyframes that share a place in what is kept.
  for (int k = in.map.size(); k <= 64; ++k) addKeyframe(in.map, {2, 2, 0.3}, in.at({2, 2, 0.3}), 0.6, 1);
  const auto scoreOf = [&](int k) {
    return surfelScore(points, in.map.mapOf({k}, {2, 2}).fine, {2, 2, 0.3}, 3, 1);
  };
  const double whole = scoreOf(64);
  EXPECT_LT(scoreOf(0), 0.5 * whole);
  EXPECT_DOUBLE_EQ(scoreOf(64), whole);
}

}  // namespace
}  // namespace slam::keyframes
