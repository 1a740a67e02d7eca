#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "libslam/core/random.h"
#include "libslam/particles/particle_filter.h"
#include "tests/mapping/small_room.h"

namespace slam::particles::ring_drive {

/// Two laps through a square ring corridor, 16 m outside and 2 m wide, with niches; ranges with 1 cm of
/// noise, wheels that turn 4 % too far, drift to the left and drive 3 % too long.
struct Ring {
  std::vector<lidar::Scan> scans;
  std::vector<core::Pose2> wheels, truth;  ///< T_previous_robot; T_start_robot
};

inline std::vector<mapping::test::Wall> ringWalls() {
  std::vector<core::Point2> outer = {
      {0, 0},   {5, 0},  {5, -0.6}, {6, -0.6}, {6, 0},  {16, 0}, {16, 9}, {16.7, 9}, {16.7, 11},  {16, 11},
      {16, 16}, {4, 16}, {4, 16.5}, {2, 16.5}, {2, 16}, {0, 16}, {0, 7},  {-0.5, 7}, {-0.5, 6.2}, {0, 6.2}};
  std::vector<core::Point2> inner = {{2, 2},  {9, 2},  {9, 2.4}, {10, 2.4},
                                     {10, 2}, {14, 2}, {14, 14}, {2, 14}};
  std::vector<mapping::test::Wall> walls;
  for (const auto& loop : {outer, inner})
    for (size_t i = 0; i < loop.size(); ++i) walls.push_back({loop[i], loop[(i + 1) % loop.size()]});
  return walls;
}

inline Ring driveRound() {
  Ring ring;
  const auto walls = ringWalls();
  core::RandomStream noise(11, "ring");
  core::Pose2 T{1, 1, 0};
  const core::Pose2 T_start = T;
  const auto step = [&](const core::Pose2& motion) {
    T = T * motion;
    lidar::Scan scan;
    const int beams = 181;
    scan.time_s = 0.2 * static_cast<double>(ring.scans.size());
    scan.first_angle_rad = -core::kPi / 2, scan.step_rad = core::kPi / (beams - 1), scan.max_range_m = 12;
    for (int i = 0; i < beams; ++i) {
      const double range_m =
          mapping::test::castRay(walls, T, scan.angle(static_cast<size_t>(i))) + noise.normal(0.01);
      scan.ranges_m.push_back(range_m < scan.max_range_m ? static_cast<float>(range_m) : lidar::kNoReturn);
    }
    ring.scans.push_back(scan);
    ring.wheels.push_back({1.03 * motion.x, 0, 1.04 * motion.phi + 0.01 * motion.x + noise.normal(0.002)});
    ring.truth.push_back(core::between(T_start, T));
  };
  step({});
  for (int side = 0; side < 8; ++side) {
    for (int i = 0; i < 70; ++i) step({0.2, 0, 0});
    for (int i = 0; i < 10; ++i) step({0, 0, core::kPi / 20});
  }
  return ring;
}

inline const Ring& ring() {
  static const Ring kRing = driveRound();
  return kRing;
}

inline Motion motionOf(const core::Pose2& wheels) {
  const double xy = 0.02 + 0.1 * std::abs(wheels.x), turn = 0.05 + 0.2 * std::abs(wheels.phi);
  return {wheels, Eigen::Vector3d(xy * xy, xy * xy, turn * turn).asDiagonal()};
}

inline ParticleFilterOptions options(int count = 10, int threads = 1) {
  ParticleFilterOptions result;
  result.count = count, result.threads = threads;
  return result;
}

inline core::Trajectory run(ParticleFilter& filter, size_t scans = 10000) {
  core::Trajectory online;
  for (size_t i = 0; i < std::min(scans, ring().scans.size()); ++i)
    online.push_back(
        {ring().scans[i].time_s, filter.update(ring().scans[i], motionOf(ring().wheels[i])).T_map_robot});
  return online;
}

inline bool sameBytes(const core::Trajectory& a, const core::Trajectory& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
}

}  // namespace slam::particles::ring_drive
