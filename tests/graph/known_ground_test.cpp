// Cost by area: ground that was seen often enough gets no more keyframes, and what changes there is learnt.
#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/random.h"
#include "libslam/graph/change_marks.h"
#include "libslam/graph/graph_slam.h"
#include "tests/graph/drawn_drives.h"

namespace slam::graph {
namespace {

using namespace test_drives;

TEST(ChangeMarks, BelieveWhatStays) {
  ChangeMarks marks;
  EXPECT_FALSE(marks.look({1.05, 2.05}, 100));
  EXPECT_FALSE(marks.look({1.05, 2.05}, 109));
  EXPECT_FALSE(marks.hasStayed({1.05, 2.05}));
  EXPECT_TRUE(marks.look({1.15, 2.15}, 110.5));  // the same cell
  EXPECT_TRUE(marks.hasStayed({1.05, 2.05}));
  EXPECT_TRUE(marks.hasStayed({1.35, 2.05}));  // beside it
  EXPECT_FALSE(marks.hasStayed({1.55, 2.05}));
  // Nobody knows what was there meanwhile.
  EXPECT_FALSE(marks.look({1.05, 2.05}, 180));
  EXPECT_FALSE(marks.hasStayed({1.05, 2.05}));
  EXPECT_TRUE(marks.look({1.05, 2.05}, 190.5));
}

/// A room of 6 x 5 m with two niches, and a door to another one, which begins at x = 6.
std::vector<Wall> twoRooms() {
  auto walls = rectangle(0, 0, 12, 5);
  walls.push_back({{6, 0}, {6, 2}});
  walls.push_back({{6, 3.2}, {6, 5}});
  for (const auto& niche :
       {rectangle(0, 3.5, 0.5, 4), rectangle(2, 0, 2.6, 0.4), rectangle(10, 4.4, 10.7, 5)})
    walls.insert(walls.end(), niche.begin(), niche.end());
  return walls;
}

/// Round and round the first room.
std::vector<core::Pose2> roundTheRoom(int laps) {
  std::vector<core::Pose2> path;
  const int steps = 90;
  for (int i = 0; i < laps * steps; ++i) {
    const double angle = 2 * core::kPi * i / steps;
    path.push_back({3 + 1.4 * std::cos(angle), 2.5 + 1.1 * std::sin(angle), angle + core::kPi / 2});
  }
  return path;
}

GraphSlam mapped(const Drive& log, const keyframes::GraphOptions& options = {}) {
  GraphSlam graph(options);
  for (size_t i = 0; i < log.scans.size(); ++i) graph.process(log.scans[i], log.increments[i], true);
  return graph;
}

void append(Drive& log, const Drive& more, const core::Pose2& T_truth_more) {
  const double since_s = log.scans.back().time_s + 0.2 - more.scans.front().time_s;
  for (size_t i = 0; i < more.scans.size(); ++i) {
    log.scans.push_back(more.scans[i]);
    log.scans.back().time_s += since_s;
    log.truth.push_back(T_truth_more * more.truth[i]);
    log.increments.push_back(more.increments[i]);
  }
}

int keyframesAfter(int laps, const keyframes::GraphOptions& options = {}) {
  return mapped(drive(twoRooms(), roundTheRoom(laps), {}, 0), options).keyframeCount();
}

TEST(KnownGround, GetsNoMoreKeyframesHoweverLongTheRobotStays) {
  const int some = keyframesAfter(10), more = keyframesAfter(30);
  EXPECT_LE(more, some + some / 10);
  keyframes::GraphOptions all;
  all.known_views = 0;
  EXPECT_GT(keyframesAfter(30, all), 25 * keyframesAfter(1, all));
}

TEST(KnownGround, PosesOfScansStayRight) {
  const auto log = drive(twoRooms(), roundTheRoom(20), {}, 0.001);
  GraphSlam graph = mapped(log);
  graph.finish();
  EXPECT_LT(worstError(graph.poses(), log.truth), 0.03);
  // And how sure they are does not grow with the laps.
  const auto covariances = graph.covariances();
  ASSERT_EQ(covariances.size(), log.scans.size());
  const auto spread = [&](size_t scan) { return covariances[scan](0, 0) + covariances[scan](1, 1); };
  EXPECT_GT(spread(log.scans.size() - 1), 0);
  EXPECT_LT(spread(log.scans.size() - 1), 4 * spread(log.scans.size() / 4));
}

TEST(KnownGround, IsLeftFromTheKeyframeThatTheRobotHangsOn) {
  auto path = roundTheRoom(20);
  core::Pose2 T = path.back();
  for (; T.phi - 2 * core::kPi * 20 < 0; T.phi += 0.1) path.push_back(T);
  for (; T.x < 10; T.x += 0.1, T.y += 0.004) path.push_back({T.x, T.y, 2 * core::kPi * 20});
  const auto log = drive(twoRooms(), path, {}, 0);
  const GraphSlam graph = mapped(log);
  EXPECT_LT(core::distance(graph.poses().back(), log.truth.back()), 0.03);
  // No edge leads from where the robot entered known ground to where it left it.
  for (const auto& edge : graph.graph().edges()) {
    const core::Pose2 T_from_to = core::between(graph.keyframePose(edge.from), graph.keyframePose(edge.to));
    EXPECT_LT(core::distance(T_from_to, edge.T_from_to), 0.1) << edge.from << " to " << edge.to;
  }
}

/// Returns of all keyframes within a square, map frame.
int returnsWithin(const GraphSlam& graph, const core::Point2& centre, double half_m) {
  int count = 0;
  for (int k = 0; k < graph.keyframeCount(); ++k) {
    const auto& scan = graph.keyframeScan(k);
    for (const auto& p_robot : lidar::scanPoints(scan)) {
      const core::Point2 p = graph.keyframePose(k) * p_robot;
      count += std::abs(p.x - centre.x) < half_m && std::abs(p.y - centre.y) < half_m;
    }
  }
  return count;
}

struct Furnished {
  Drive log;
  core::Point2 box;  ///< map frame
};

/// From where the laps begin into the other room, and back with the first one in view.
std::vector<core::Pose2> toTheOtherRoom() {
  std::vector<core::Pose2> path;
  for (double turn = core::kPi / 2; turn > 0; turn -= 0.1) path.push_back({4.4, 2.5, turn});
  for (double x = 4.4; x < 10; x += 0.1) path.push_back({x, 2.5, 0});
  for (double turn = 0; turn < core::kPi; turn += 0.1) path.push_back({10, 2.5, turn});
  for (double x = 10; x > 4.4; x -= 0.1) path.push_back({x, 2.5, core::kPi});
  for (double turn = core::kPi; turn > core::kPi / 2; turn -= 0.1) path.push_back({4.4, 2.5, turn});
  return path;
}

/// The first room, `before` laps; then with a box in its middle for so many, and from the other room; then
/// without.
Furnished withABox(int before, int laps, int after) {
  auto walls = twoRooms();
  const auto path = roundTheRoom(1);
  Furnished result;
  result.log = drive(walls, roundTheRoom(before), {}, 0, 1);
  auto furnished = walls;
  const auto box = rectangle(2.7, 2.2, 3.3, 2.8);
  furnished.insert(furnished.end(), box.begin(), box.end());
  if (laps > 0) {
    append(result.log, drive(furnished, roundTheRoom(laps), {}, 0, 2), {});
    append(result.log, drive(furnished, toTheOtherRoom(), {}, 0, 4), {});
  }
  if (after > 0) append(result.log, drive(walls, roundTheRoom(after), {}, 0, 3), {});
  result.box = core::inverse(path[0]) * core::Point2{3, 2.5};
  return result;
}

TEST(KnownGround, LearnsWhatIsNewAndForgetsWhatHasGone) {
  const auto before = withABox(15, 0, 0);
  EXPECT_EQ(returnsWithin(mapped(before.log), before.box, 0.45), 0);
  const auto with = withABox(15, 6, 0);
  const GraphSlam furnished = mapped(with.log);
  EXPECT_GT(returnsWithin(furnished, with.box, 0.45), 100);
  const auto without = withABox(15, 6, 8);
  const GraphSlam emptied = mapped(without.log);
  EXPECT_LT(returnsWithin(emptied, without.box, 0.45), returnsWithin(furnished, with.box, 0.45) / 20);
  EXPECT_GT(emptied.revision(), 0);
}

TEST(KnownGround, KeepsNothingOfWhatPassesBy) {
  auto log = drive(twoRooms(), roundTheRoom(15), {}, 0);
  const int keyframes = mapped(log).keyframeCount();
  auto walls = twoRooms();
  const auto person = rectangle(2.9, 2.4, 3.2, 2.7);
  walls.insert(walls.end(), person.begin(), person.end());
  const auto all = roundTheRoom(2);
  // Eight seconds: 40 scans of the second of two laps.
  auto passing = drive(twoRooms(), all, {}, 0, 2);
  const auto seen = drive(walls, all, {}, 0, 2);
  for (size_t i = 100; i < 140; ++i) passing.scans[i] = seen.scans[i];
  append(log, passing, {});
  const GraphSlam graph = mapped(log);
  EXPECT_LE(graph.keyframeCount(), keyframes + 2);
  EXPECT_EQ(returnsWithin(graph, core::inverse(all[0]) * core::Point2{3.05, 2.55}, 0.4), 0);
}

}  // namespace
}  // namespace slam::graph
