#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/graph/graph_slam.h"
#include "tests/graph/drawn_drives.h"

namespace slam::graph {
namespace {

using namespace test_drives;

/// A scan per half metre, and turns that come and go at once.
std::vector<core::Pose2> jerkyPath() {
  std::vector<core::Pose2> path;
  core::Pose2 T{4, 4, 0};
  for (int i = 0; i < 60; ++i) {
    path.push_back(T);
    const double turn_rad[] = {0, 0, 0.7, 0, -0.2, 0.6};
    T = T * core::Pose2{0.4, 0, turn_rad[i % 6]};
  }
  return path;
}

Drive slowly(Drive log) {
  for (size_t i = 0; i < log.scans.size(); ++i) log.scans[i].time_s = 1000 + 2.0 * static_cast<double>(i);
  return log;
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

// What wheels say of a turn belongs in part to the step before, as where odometry leads the scans.
TEST(Slip, IsNoneWhereWheelsKeepAnotherTimeThanTheLidar) {
  for (const double share : {0.3, 0.5}) {
    auto log = slowly(drive(yard(), jerkyPath(), {}, 0));
    const auto on_time = log.increments;
    for (size_t i = 1; i < log.increments.size(); ++i)
      log.increments[i].phi = (1 - share) * on_time[i].phi + share * on_time[i - 1].phi;
    EXPECT_LT(errorIn(log), 0.1) << share;
  }
}

// On a straight way, so that wheels are thought good; then they turn and the robot does not, or not so far.
TEST(Slip, OfATurnIsFollowedByTheScans) {
  for (const double said_rad : {-0.28, 0.28}) {
    std::vector<core::Pose2> path;
    for (int i = 0; i < 16; ++i) path.push_back({2 + 0.5 * i, 5, 0});
    auto log = slowly(drive(yard(), path, {}, 0));
    log.increments[9].phi += said_rad;
    EXPECT_LT(errorIn(log), 0.1) << said_rad;
  }
}

// Wheels that turn on a sill: they go on, the robot stays.
TEST(Slip, OfAMetreIsFollowedByTheScans) {
  std::vector<core::Pose2> path;
  for (int i = 0; i < 16; ++i) path.push_back({2 + 0.5 * (i < 9 ? i : i - 1), 5, 0});
  auto log = slowly(drive(yard(), path, {}, 0));
  log.increments[9] = {1.2, 0, 0.1};
  EXPECT_LT(errorIn(log), 0.1);
}

}  // namespace
}  // namespace slam::graph
