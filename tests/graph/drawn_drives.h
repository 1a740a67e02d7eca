#pragma once
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "tests/scanmatch/drawn_rooms.h"

/// Drawn buildings, and drives through them, for tests of graph SLAM.
namespace slam::graph::test_drives {

using scanmatch_test::Lidar;
using scanmatch_test::look;
using scanmatch_test::rectangle;
using scanmatch_test::Wall;

inline void add(std::vector<Wall>& walls, const std::vector<Wall>& more) {
  walls.insert(walls.end(), more.begin(), more.end());
}

/// A corridor of 2 m around a block of 16 x 10 m, with niches in its outer wall that tell places apart.
inline std::vector<Wall> ring() {
  auto walls = rectangle(0, 0, 20, 14);
  const auto block = rectangle(2, 2, 18, 12);
  walls.insert(walls.end(), block.begin(), block.end());
  for (const double x : {3.0, 6.5, 8.0, 13.5, 16.0}) {
    const auto pillar = rectangle(x, 0, x + 0.4, 0.3);
    walls.insert(walls.end(), pillar.begin(), pillar.end());
  }
  for (const double y : {4.0, 9.0}) {
    const auto pillar = rectangle(19.6, y, 20, y + 0.5);
    walls.insert(walls.end(), pillar.begin(), pillar.end());
  }
  for (const double x : {5.0, 11.0, 12.5}) {
    const auto pillar = rectangle(x, 13.7, x + 0.6, 14);
    walls.insert(walls.end(), pillar.begin(), pillar.end());
  }
  return walls;
}

/// Two rooms' worth of space, with pillars that tell places apart.
inline std::vector<Wall> yard() {
  auto walls = rectangle(0, 0, 14, 11);
  for (const core::Point2& p :
       {core::Point2{2, 2}, {11.5, 1.2}, {12.3, 8}, {3.1, 9.2}, {7.4, 10}, {8.2, 0.5}})
    add(walls, rectangle(p.x, p.y, p.x + 0.4, p.y + 0.3));
  return walls;
}

/// Along the middle of the corridor, turning on the spot at its corners.
inline std::vector<core::Pose2> lapsAround(int laps) {
  const core::Point2 corners[] = {{1, 1}, {19, 1}, {19, 13}, {1, 13}};
  std::vector<core::Pose2> path;
  for (int side = 0; side < 4 * laps; ++side) {
    const core::Point2 a = corners[side % 4], b = corners[(side + 1) % 4];
    const double heading = std::atan2(b.y - a.y, b.x - a.x), length = core::distance(a, b);
    for (double s = 0; s < length; s += 0.1)
      path.push_back({a.x + s / length * (b.x - a.x), a.y + s / length * (b.y - a.y), heading});
    for (double turn = 0.1; turn < core::kPi / 2; turn += 0.1) path.push_back({b.x, b.y, heading + turn});
  }
  return path;
}

inline std::vector<core::Pose2> along(const std::vector<core::Point2>& corners, double step_m) {
  std::vector<core::Pose2> path;
  for (size_t i = 0; i + 1 < corners.size(); ++i) {
    const core::Point2 a = corners[i], b = corners[i + 1];
    const double heading = std::atan2(b.y - a.y, b.x - a.x), length = core::distance(a, b);
    if (!path.empty()) {
      const double from = path.back().phi, turn = core::angleDifference(heading, from);
      for (double share = 0.125; share < 1; share += 0.125) path.push_back({a.x, a.y, from + share * turn});
    }
    for (double s = 0; s < length - 1e-9; s += step_m)
      path.push_back({a.x + s / length * (b.x - a.x), a.y + s / length * (b.y - a.y), heading});
  }
  return path;
}

struct Drive {
  std::vector<lidar::Scan> scans;
  std::vector<core::Pose2> truth, increments;  ///< truth from the first pose; increments as odometry has them
};

inline Drive drive(const std::vector<Wall>& walls, const std::vector<core::Pose2>& path, const Lidar& lidar,
                   double turn_bias_rad, std::uint64_t seed = 1) {
  core::RandomStream readings(seed, "lidar"), wheels(seed, "wheels");
  Drive result;
  for (size_t i = 0; i < path.size(); ++i) {
    result.scans.push_back(look(walls, path[i], lidar, readings));
    result.scans.back().time_s = 1000 + 0.2 * static_cast<double>(i);
    result.truth.push_back(core::between(path[0], path[i]));
    core::Pose2 moved = i ? core::between(path[i - 1], path[i]) : core::Pose2{};
    moved.x *= 1.03 + 0.05 * wheels.normal();
    moved.phi += turn_bias_rad + 0.02 * moved.phi;
    result.increments.push_back(moved);
  }
  return result;
}

/// The drive, with a scan for every `nth` step from step `first` on.
inline Drive everyNth(const Drive& log, size_t nth, size_t first = 0) {
  Drive kept;
  core::Pose2 increment;
  for (size_t i = 0; i < log.scans.size(); ++i) {
    increment = increment * log.increments[i];
    if (i > first && i % nth != 0) continue;
    kept.scans.push_back(log.scans[i]);
    kept.truth.push_back(log.truth[i]);
    kept.increments.push_back(std::exchange(increment, {}));
  }
  return kept;
}

inline double worstError(const std::vector<core::Pose2>& estimate, const std::vector<core::Pose2>& truth) {
  double worst = 0;
  for (size_t i = 0; i < truth.size(); ++i) worst = std::max(worst, core::distance(estimate[i], truth[i]));
  return worst;
}

}  // namespace slam::graph::test_drives
