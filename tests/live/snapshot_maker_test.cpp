#include "libslam/live/snapshot_maker.h"

#include <gtest/gtest.h>

#include "libslam/record/record.h"
#include "libslam/resources/resources.h"

namespace slam::live {
namespace {

lidar::Scan scanAt(double time_s, float range_m = 2) {
  lidar::Scan scan;
  scan.time_s = time_s;
  scan.first_angle_rad = -1, scan.step_rad = 0.1, scan.max_range_m = 10;
  scan.ranges_m.assign(21, range_m);
  return scan;
}

TEST(SnapshotMaker, CollectsThePathAndWhatLiesAround) {
  SnapshotMaker maker("title", "method", {5, 0, 0});
  const auto first = scanAt(100), second = scanAt(101);
  maker.add({0, first, {}, {}});
  maker.add({1, second, {1, 0, 0}, {1, 0, 0}});
  const auto snapshot = maker.snapshot(nullptr, true);
  EXPECT_EQ(snapshot.title, "title");
  EXPECT_EQ(snapshot.scans, 2U);
  EXPECT_EQ(snapshot.time_s, 1);
  EXPECT_EQ(snapshot.path.size(), 2U);
  EXPECT_EQ(snapshot.T_scene_map.x, 5);
  EXPECT_FALSE(snapshot.map);
  EXPECT_FALSE(snapshot.T_scene_truth);
  EXPECT_FALSE(snapshot.candidates);
  ASSERT_TRUE(snapshot.obstacles);
  EXPECT_FALSE(snapshot.obstacles->seen.empty());
  EXPECT_FALSE(snapshot.obstacles->visible.empty());
}

TEST(SnapshotMaker, FindsTheTruthByTheStamps) {
  SnapshotMaker maker("", "", {});
  maker.setTruth({{100, {1, 2, 0}}, {101, {2, 2, 0}}});
  const auto inside = scanAt(100.5), outside = scanAt(105);
  maker.add({0, inside, {}, {}});
  auto snapshot = maker.snapshot(nullptr, false);
  ASSERT_TRUE(snapshot.T_scene_truth);
  EXPECT_NEAR(snapshot.T_scene_truth->x, 1.5, 1e-9);
  maker.add({4.5, outside, {}, {}});
  snapshot = maker.snapshot(nullptr, false);
  EXPECT_FALSE(snapshot.T_scene_truth);
  EXPECT_EQ(snapshot.truth.size(), 1U);
}

TEST(SnapshotMaker, PlacesAChoiceWithoutAMapWhereItWasTaken) {
  SnapshotMaker maker("", "", {});
  choices::Decision decision;
  decision.turn_rad = core::kPi / 2;
  decision.distance_m = 3;
  decision.alternatives = {{1, 0}};
  decision.reason = "longest ray";
  const auto scan = scanAt(100);
  maker.add({0, scan, {}, {2, 0, 0}, nullptr, nullptr, &decision});
  // The robot has turned and gone half the way: the goal stays.
  maker.add({1, scan, {}, {2, 1.5, core::kPi / 2}, nullptr, nullptr, &decision});
  const auto snapshot = maker.snapshot(nullptr, false);
  ASSERT_TRUE(snapshot.candidates);
  EXPECT_NEAR(snapshot.candidates->goal.x, 2, 1e-9);
  EXPECT_NEAR(snapshot.candidates->goal.y, 3, 1e-9);
  EXPECT_NEAR(snapshot.candidates->places.at(0).x, 3, 1e-9);
  EXPECT_EQ(snapshot.note, "longest ray");
}

TEST(SnapshotMaker, TakesAChoiceOnTheMapAsItIs) {
  SnapshotMaker maker("", "", {});
  choices::Decision decision;
  decision.path = {{1, 1}, {4, 5}};
  decision.goal = {4, 5};
  decision.alternatives = {{7, 7}};
  const auto scan = scanAt(100);
  maker.add({0, scan, {}, {2, 0, 1}, nullptr, nullptr, &decision});
  const auto snapshot = maker.snapshot(nullptr, false);
  EXPECT_EQ(snapshot.candidates->goal.x, 4);
  EXPECT_EQ(snapshot.candidates->places.at(0).x, 7);
  EXPECT_EQ(snapshot.candidates->path.size(), 3U);
}

TEST(SnapshotMaker, KeepsAGoalThatNoStrategyChose) {
  SnapshotMaker maker("", "", {});
  maker.setGoal({3, 4});
  const auto scan = scanAt(100);
  record::Step step{0, scan, {}, {}};
  step.note = "to the goal";
  maker.add(step);
  const auto snapshot = maker.snapshot(nullptr, false);
  ASSERT_TRUE(snapshot.candidates);
  EXPECT_EQ(snapshot.candidates->goal.y, 4);
  EXPECT_EQ(snapshot.note, "to the goal");
}

TEST(SnapshotMaker, ShowsTheStrategicDirectionsUpToTheirReadings) {
  SnapshotMaker maker("", "", {});
  maker.setStrategicView(0.4, {0, 0.5, core::kPi});
  auto scan = scanAt(100, 1.5);
  scan.ranges_m[15] = lidar::kNoReturn;  // at 0.5
  maker.add({0, scan, {}, {}});
  const auto strategic = maker.snapshot(nullptr, false).strategic;
  ASSERT_TRUE(strategic);
  EXPECT_EQ(strategic->stop_radius_m, 0.4);
  ASSERT_EQ(strategic->projected.size(), 2U);  // nothing is known of what is behind
  EXPECT_NEAR(strategic->projected[0].x, 1.5, 1e-6);
  EXPECT_NEAR(strategic->projected[0].y, 0, 1e-6);
  EXPECT_GT(strategic->projected[1].x, 1.5);  // free as far as it is drawn
}

TEST(SnapshotMaker, ACarryBreaksTheTruePathAndIsSaid) {
  const auto plan = world::loadPlan(resources::resolvePlan("flat"));
  lidar::LidarOptions lidar;
  lidar.beams = 21;
  sim::Simulator simulator(plan, {}, lidar, {}, {3, 3, 0}, 1);
  simulator.carryAt(sim::parseCarries("1:11,3,90", "test"));
  SnapshotMaker maker("", "", {});
  auto sensed = simulator.sense();
  maker.add({0, sensed.scan, {}, {}, nullptr, &simulator});
  sensed = simulator.step({0.1, 0, 1});
  maker.add({1, sensed.scan, {}, {}, nullptr, &simulator});
  const auto snapshot = maker.snapshot(nullptr, false);
  EXPECT_EQ(snapshot.note, "the robot was kidnapped");
  ASSERT_EQ(snapshot.truth.size(), 3U);
  EXPECT_FALSE(core::isFinite(snapshot.truth[1].pose));
  EXPECT_EQ(snapshot.truth[2].pose.x, 11);
}

TEST(SnapshotMaker, ShowsALoopOnlyOnceItWasClosed) {
  SnapshotMaker maker("", "", {});
  maker.setLoops({{1, {{0, 0}, {1, 1}}}, {1, {{0, 0}, {2, 2}}}, {3, {{0, 0}, {3, 3}}}});
  const size_t expected[] = {0, 2, 2, 3};
  for (int i = 0; i < 4; ++i) {
    const auto scan = scanAt(100 + i);
    maker.add({1.0 * i, scan, {}, {}});
    EXPECT_EQ(maker.snapshot(nullptr, false).loops.size(), expected[i]) << i;
  }
}

TEST(SnapshotMaker, AsksAMethodForItsMapOnlyWhenToldTo) {
  auto method = mapping::makeMapBuilder(
      mapping::loadMethodConfig(resources::configsFolder() + "/methods", "naive_wheel"), "naive_wheel", 1);
  SnapshotMaker maker("", "", {});
  const auto step = [&](double time_s) {
    const auto scan = scanAt(100 + time_s);
    maker.add({time_s, scan, {1, 0, 0}, mapping::processScan(method, scan, {1, 0, 0}, true), &method});
  };
  step(0);
  const auto first = maker.snapshot(&method, true);
  ASSERT_TRUE(first.map);
  step(1);
  const auto second = maker.snapshot(&method, false);
  EXPECT_EQ(second.map, first.map);
  EXPECT_EQ(second.path.size(), 2U);  // the path grows all the same
  EXPECT_NE(maker.snapshot(&method, true).map, first.map);
}

}  // namespace
}  // namespace slam::live
