// Maps of before, whose places in one another are not known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libslam/core/error.h"
#include "libslam/core/progress.h"
#include "libslam/graph/graph_slam.h"
#include "tests/graph/drawn_drives.h"

namespace slam::graph {
namespace {

using namespace test_drives;

/// The keyframes of a drive through a building, in the frame of its first pose.
GraphSlam mapped(const std::vector<Wall>& walls, const std::vector<core::Pose2>& path, std::uint64_t seed,
                 const Lidar& lidar = {}) {
  const auto log = drive(walls, path, lidar, 0, seed);
  GraphSlam graph{keyframes::GraphOptions()};
  for (size_t i = 0; i < log.scans.size(); ++i) graph.process(log.scans[i], log.increments[i], true);
  graph.finish();
  return graph;
}

void addKeyframes(const GraphSlam& of, GraphSlam& to) {
  for (int k = 0; k < of.keyframeCount(); ++k) to.addKnownKeyframe(of.keyframeScan(k), of.keyframePose(k));
}

/// The same lap from somewhere on the way.
std::vector<core::Pose2> lapFrom(size_t first) {
  std::vector<core::Pose2> path = lapsAround(1);
  std::rotate(path.begin(), path.begin() + static_cast<long>(first), path.end());
  return path;
}

TEST(KnownParts, AreJoinedWhereTheyLie) {
  const auto there = lapsAround(1), back = lapFrom(250);
  const auto first = mapped(ring(), there, 1), second = mapped(ring(), back, 2);
  GraphSlam both{keyframes::GraphOptions()};
  addKeyframes(first, both);
  both.beginKnownPart();
  addKeyframes(second, both);
  const auto places = both.joinParts(core::silentProgress());
  ASSERT_EQ(places.size(), 1U);
  ASSERT_TRUE(places[0].is_joined);
  const auto expected = core::between(there[0], back[0]);
  EXPECT_LT(core::distance(places[0].T_map_part, expected), 0.05);
  EXPECT_LT(std::abs(core::angleDifference(places[0].T_map_part.phi, expected.phi)), 0.01);
  EXPECT_GT(places[0].shared, 0.9);
  EXPECT_LT(places[0].contradicted, 0.05);
  EXPECT_GE(places[0].fitting, keyframes::GraphOptions().loop_confirmations);
  EXPECT_GT(places[0].ahead_nats, 14);
  // One map: what the second saw last lies where the first has it.
  const int last = both.keyframeCount() - 1;
  EXPECT_LT(
      core::distance(both.keyframePose(last), expected * second.keyframePose(second.keyframeCount() - 1)),
      0.1);
}

TEST(KnownParts, KeepHowTheirKeyframesLieWhenMoreIsDriven) {
  const auto before = mapped(ring(), lapsAround(1), 1);
  GraphSlam graph{keyframes::GraphOptions()};
  addKeyframes(before, graph);
  graph.startAt({});
  const auto log = drive(ring(), lapsAround(1), {}, 0, 2);
  for (size_t i = 0; i < log.scans.size(); ++i) graph.process(log.scans[i], log.increments[i], true);
  graph.finish();
  int known = 0;
  for (const auto& edge : graph.graph().edges()) {
    if (edge.to >= before.keyframeCount() || edge.from != edge.to - 1) continue;
    const auto expected = core::between(before.keyframePose(edge.from), before.keyframePose(edge.to));
    EXPECT_LT(core::distance(edge.T_from_to, expected), 0.01) << edge.to;
    ++known;
  }
  EXPECT_GE(known, before.keyframeCount() - 1);
}

TEST(KnownParts, OfAnotherBuildingStayApart) {
  auto walls = rectangle(0, 0, 9, 7);
  for (const double x : {2.0, 5.5}) {
    const auto table = rectangle(x, 3, x + 1.1, 4.2);
    walls.insert(walls.end(), table.begin(), table.end());
  }
  std::vector<core::Pose2> path;
  for (double s = 0; s < 6; s += 0.1) path.push_back({1.2 + s, 1.5, 0});
  for (double turn = 0.1; turn < core::kPi / 2; turn += 0.1) path.push_back({7.2, 1.5, turn});
  for (double s = 0; s < 4; s += 0.1) path.push_back({7.2, 1.5 + s, core::kPi / 2});
  const auto first = mapped(ring(), lapsAround(1), 1), second = mapped(walls, path, 2);
  GraphSlam both{keyframes::GraphOptions()};
  addKeyframes(first, both);
  both.beginKnownPart();
  addKeyframes(second, both);
  const auto places = both.joinParts(core::silentProgress());
  EXPECT_FALSE(places.at(0).is_joined);
  // Far away, where it takes part in nothing.
  EXPECT_GT(both.keyframePose(first.keyframeCount()).x, 500);
}

// Then all poses are found anew.
TEST(KnownParts, StayApartWhenALoopClosesInAnotherOne) {
  const auto log = drive(ring(), lapsAround(2), {}, 2e-3);
  keyframes::GraphOptions open;
  open.loops = false, open.map_path_m = 10;
  GraphSlam first{open};
  for (size_t i = 0; i < log.scans.size(); ++i) first.process(log.scans[i], log.increments[i], true);
  const auto second = mapped(rectangle(0, 0, 9, 7), along({{1.2, 1.5}, {7.2, 1.5}, {7.2, 5}}, 0.1), 2);
  GraphSlam both{keyframes::GraphOptions()};
  addKeyframes(first, both);
  both.beginKnownPart();
  addKeyframes(second, both);
  const auto places = both.joinParts(core::silentProgress());
  ASSERT_TRUE(std::any_of(both.journal().begin(), both.journal().end(),
                          [](const auto& entry) { return entry.event == core::JournalEvent::kAccepted; }));
  EXPECT_FALSE(places.at(0).is_joined);
  EXPECT_GT(both.keyframePose(first.keyframeCount()).x, 500);
}

TEST(KnownParts, AMapBetweenTwoOthersJoinsBoth) {
  // Two corners of the ring that have nothing in common, and the way between.
  const auto whole = lapsAround(1);
  const std::vector<core::Pose2> near(whole.begin(), whole.begin() + 190),
      far(whole.begin() + 330, whole.begin() + 520), between(whole.begin() + 90, whole.begin() + 440);
  // Its far side is wider: half a turn does not make the ring the same.
  auto walls = ring();
  for (auto& wall : walls)
    for (auto* end : {&wall.a, &wall.b})
      if (end->y == 12) end->y = 10.5;
  const auto a = mapped(walls, near, 1), b = mapped(walls, far, 2), c = mapped(walls, between, 3);
  GraphSlam all{keyframes::GraphOptions()};
  addKeyframes(a, all);
  for (const auto* part : {&c, &b}) {
    all.beginKnownPart();
    addKeyframes(*part, all);
  }
  const auto places = all.joinParts(core::silentProgress());
  ASSERT_EQ(places.size(), 2U);
  ASSERT_TRUE(places[0].is_joined && places[1].is_joined);
  EXPECT_LT(core::distance(places[1].T_map_part, core::between(near[0], far[0])), 0.15);
  EXPECT_LT(core::distance(places[0].T_map_part, core::between(near[0], between[0])), 0.1);
}

TEST(KnownParts, AreNotJoinedWhereTwoPlacesAreAsGood) {
  // Turned by half a turn the room is the same.
  const auto walls = rectangle(0, 0, 12, 8);
  std::vector<core::Pose2> one, other;
  for (double s = 0; s < 8; s += 0.1) {
    one.push_back({2 + s, 2.5, 0});
    other.push_back({3 + 0.7 * s, 1.8 + 0.2 * s, 0.3});
  }
  Lidar all_round;
  all_round.beams = 361;
  all_round.fov_rad = 2 * core::kPi;
  const auto first = mapped(walls, one, 1, all_round), second = mapped(walls, other, 2, all_round);
  GraphSlam both{keyframes::GraphOptions()};
  addKeyframes(first, both);
  both.beginKnownPart();
  addKeyframes(second, both);
  EXPECT_FALSE(both.joinParts(core::silentProgress()).at(0).is_joined);
}

TEST(KnownParts, HaveRules) {
  GraphSlam empty{keyframes::GraphOptions()};
  EXPECT_THROW(empty.beginKnownPart(), core::ContractError);
  keyframes::GraphOptions options;
  options.loops = false;
  GraphSlam without(options);
  EXPECT_THROW(without.joinParts(core::silentProgress()), core::ContractError);
}

}  // namespace
}  // namespace slam::graph
