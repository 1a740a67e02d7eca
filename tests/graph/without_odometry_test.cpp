// What tells where a robot went whose wheels say nothing.
#include <gtest/gtest.h>

#include "libslam/graph/graph_slam.h"
#include "tests/graph/drawn_drives.h"

namespace slam::graph {
namespace {

using namespace test_drives;

/// The farthest that any pose is off.
double worstWithoutOdometry(const Drive& log) {
  GraphSlam graph{keyframes::GraphOptions()};
  for (const auto& scan : log.scans) graph.process(scan, {}, false);
  return worstError(graph.poses(), log.truth);
}

// Without odometry, two scans a second, up to 90 degrees and half a metre apart: how far two scans are
// searched for the motion between them goes by the time between them.
TEST(WithoutOdometry, FastTurnsAreFoundHoweverFarApartScansAre) {
  std::vector<core::Pose2> path;
  core::Pose2 T{7, 5, 0};
  for (int i = 0; i < 24; ++i) {
    path.push_back(T);
    T = T * core::Pose2{i % 3 == 0 ? 0.5 : 0.0, 0, i % 3 == 0 ? 0.0 : (i % 2 == 0 ? 1.5 : -1.2)};
  }
  Lidar full;
  full.fov_rad = 2 * core::kPi * 359 / 360, full.beams = 360;
  auto log = drive(yard(), path, full, 0);
  for (size_t i = 0; i < log.scans.size(); ++i) log.scans[i].time_s = 1000 + 0.5 * static_cast<double>(i);
  GraphSlam graph{keyframes::GraphOptions()};
  for (const auto& scan : log.scans) graph.process(scan, {}, false);
  EXPECT_LT(worstError(graph.poses(), log.truth), 0.05);
}

// Without odometry, a metre between two scans along a corridor: they look like one, and the robot seems to
// stand. Its map knows better.
TEST(WithoutOdometry, FastStepsAlongACorridorAreFound) {
  Lidar full;
  full.fov_rad = 2 * core::kPi * 359 / 360, full.beams = 360, full.max_range_m = 8;
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    auto log = drive(ring(), along({{10, 1}, {3, 1}, {18, 1}, {3, 1}, {17, 1}}, 1.0), full, 0, seed);
    for (size_t i = 0; i < log.scans.size(); ++i) log.scans[i].time_s = 1000 + 0.5 * static_cast<double>(i);
    GraphSlam graph{keyframes::GraphOptions()};
    for (const auto& scan : log.scans) graph.process(scan, {}, false);
    EXPECT_LT(worstError(graph.poses(), log.truth), 0.1) << seed;
  }
}

/// Nothing but legs of tables and chairs: no two beams tell which way a surface faces.
std::vector<Wall> legs(std::uint64_t seed) {
  core::RandomStream place(seed, "legs");
  std::vector<Wall> walls;
  for (int i = 0; i < 150; ++i) {
    const double x = place.uniform(0, 12), y = place.uniform(0, 12);
    if (std::hypot(x - 6, y - 6) < 1) continue;
    add(walls, rectangle(x, y, x + 0.1, y + 0.1));
  }
  return walls;
}

// Two scans of legs alone do not tell the motion between them. The robot turns by anything up to 0.8 rad from
// one to the next: each turn is looked for over all within reach.
TEST(WithoutOdometry, TurnsThatGoOnLikeNoneBeforeAreFound) {
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    core::RandomStream turns(seed, "turns");
    std::vector<core::Pose2> path;
    double heading = 0;
    for (int i = 0; i < 90; ++i) {
      path.push_back({6, 6, heading});
      heading += i < 10 ? 0.05 : turns.uniform(-0.8, 0.8);
    }
    EXPECT_LT(worstWithoutOdometry(drive(legs(seed), path, {}, 0, seed)), 0.1) << seed;
  }
}

}  // namespace
}  // namespace slam::graph
