#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/graph/graph_slam.h"
#include "tests/graph/drawn_drives.h"

namespace slam::graph {
namespace {

using namespace test_drives;

/// Once around the block and a little farther, by a lidar that sees so far round, with every `nth` scan
/// alone.
Drive aroundTheBlock(double fov_rad, size_t nth) {
  Lidar lidar;
  lidar.beams = 91, lidar.fov_rad = fov_rad;
  auto path = lapsAround(2);
  path.resize(path.size() * 3 / 5);
  return everyNth(drive(ring(), path, lidar, 0), nth);
}

/// The farthest from the truth that a pose is when its scan has come, metres and radians together.
double errorIn(const Drive& log) {
  GraphSlam graph{keyframes::GraphOptions()};
  double worst = 0;
  for (size_t i = 0; i < log.scans.size(); ++i) {
    const core::Pose2 T = graph.process(log.scans[i], log.increments[i], true).T_map_robot;
    const core::Pose2 off = core::between(log.truth[i], T);
    worst = std::max(worst, core::hypot(off.x, off.y) + std::abs(off.phi));
  }
  return worst;
}

/// Along a corridor with posts of door frames on both sides, a turn about in steps of 0.6 rad, and back. The
/// last of these steps.
std::pair<Drive, size_t> alongTheDoors(double apart_m, double wide_m, double deep_m) {
  auto walls = rectangle(0, 0, 60, wide_m);
  for (double x = 2; x < 58; x += apart_m) {
    add(walls, rectangle(x, 0, x + 0.25, deep_m));
    add(walls, rectangle(x + apart_m / 2, wide_m - deep_m, x + apart_m / 2 + 0.25, wide_m));
  }
  std::vector<core::Pose2> path;
  for (double x = 10; x < 34; x += 0.6) path.push_back({x, 1.1, 0});
  for (double turn = 0.6; turn < core::kPi; turn += 0.6) path.push_back({path.back().x, 1.1, turn});
  const size_t last_turn = path.size() + 1;
  for (double x = path.back().x; x > 20; x -= 0.6) path.push_back({x, 1.1, core::kPi});
  Lidar lidar;
  lidar.max_range_m = 8, lidar.T_robot_lidar = {0.24, 0, 0};
  return {drive(walls, path, lidar, 0), last_turn};
}

// What wheels say of a turn belongs in part to the step before, as where odometry leads the scans: on turns
// of a scan or two, the next step errs by as much.
TEST(Slip, IsNoneWhereWheelsKeepAnotherTimeThanTheLidar) {
  for (const auto& [fov_rad, nth] : {std::pair(3.1, 13), std::pair(2.1, 8)})
    for (const double share : {0.2, 0.35, 0.5}) {
      auto log = aroundTheBlock(fov_rad, static_cast<size_t>(nth));
      const auto on_time = log.increments;
      for (size_t i = 1; i < log.increments.size(); ++i)
        log.increments[i].phi = (1 - share) * on_time[i].phi + share * on_time[i - 1].phi;
      EXPECT_LT(errorIn(log), 0.2) << share << " of the step before, every " << nth;
    }
}

// At a corner wheels turn and the robot does not as far, or farther; behind it most of what it sees is new.
TEST(Slip, OfATurnIsFollowedByTheScans) {
  const auto clean = aroundTheBlock(1.6, 6);
  int slips = 0;
  for (size_t i = 1; i < clean.increments.size(); ++i) {
    if (std::abs(clean.increments[i].phi) < 0.3) continue;
    for (const double said_rad : {-0.4, 0.4}) {
      auto log = clean;
      log.increments[i].phi += said_rad;
      EXPECT_LT(errorIn(log), 0.15) << i << " " << said_rad;
      ++slips;
    }
  }
  EXPECT_GT(slips, 10);
}

/// Two corridors of 3 m that cross in the middle of each.
std::vector<Wall> crossing() {
  std::vector<Wall> walls;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0}) {
      walls.push_back({{1.5 * x, 1.5 * y}, {15 * x, 1.5 * y}});
      walls.push_back({{1.5 * x, 1.5 * y}, {1.5 * x, 15 * y}});
    }
  for (const double end : {-15.0, 15.0}) {
    walls.push_back({{end, -1.5}, {end, 1.5}});
    walls.push_back({{-1.5, end}, {1.5, end}});
  }
  return walls;
}

// A scan that has to be turned back by so much slides along the corridor meanwhile, and a door is like the
// next.
TEST(Slip, OfATurnDoesNotMoveTheRobotAlongACorridor) {
  for (const auto& [apart_m, wide_m, deep_m] :
       {std::tuple(2.5, 3.0, 0.1), {2.5, 3.0, 0.4}, {3.4, 2.2, 0.1}, {3.4, 3.0, 0.1}}) {
    const auto [clean, last_turn] = alongTheDoors(apart_m, wide_m, deep_m);
    for (const double said_rad : {-0.65, 0.5, 0.65}) {
      auto log = clean;
      log.increments[last_turn].phi += said_rad;
      EXPECT_LT(errorIn(log), 0.5) << apart_m << " " << wide_m << " " << deep_m << " " << said_rad;
    }
  }
}

// The map of the first scans holds little. It has to grow although wheels are wrong.
TEST(Slip, InTheFirstScansLeavesTheMapToGrow) {
  Lidar lidar;
  lidar.beams = 81, lidar.fov_rad = 4.2, lidar.max_range_m = 30;
  const auto clean = drive(crossing(), along({{-12, 0.1}, {12, -0.2}}, 0.5), lidar, 0);
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    auto log = clean;
    core::RandomStream wheels(seed, "turns");
    for (auto& increment : log.increments) increment.phi += 0.2 * wheels.normal();
    EXPECT_LT(errorIn(log), 0.6) << seed;
  }
}

}  // namespace
}  // namespace slam::graph
