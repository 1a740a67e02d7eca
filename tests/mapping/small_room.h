#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/lidar/scan.h"
#include "libslam/logs/log_reader.h"

namespace slam::mapping::test {

/// A wall from a to b, in metres, without thickness: ranges to it are exact.
struct Wall {
  core::Point2 a, b;
};

/// A room of 8 x 6 m with a box, a closet and a slanted corner, so that no pose looks like another.
inline std::vector<Wall> smallRoom() {
  const std::vector<core::Point2> outline = {{-2, -3}, {6, -3}, {6, 2}, {5, 3}, {0, 3}, {0, 2}, {-2, 2}};
  const std::vector<core::Point2> box = {{2.5, -1.8}, {3.4, -1.8}, {3.4, -1.1}, {2.5, -1.1}};
  std::vector<Wall> walls;
  for (const auto& loop : {outline, box})
    for (size_t i = 0; i < loop.size(); ++i) walls.push_back({loop[i], loop[(i + 1) % loop.size()]});
  return walls;
}

/// Distance along the ray to the nearest wall; infinity when there is none.
inline double castRay(const std::vector<Wall>& walls, const core::Pose2& T_room_lidar, double angle_rad) {
  const double dx = std::cos(T_room_lidar.phi + angle_rad), dy = std::sin(T_room_lidar.phi + angle_rad);
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& wall : walls) {
    const double ex = wall.b.x - wall.a.x, ey = wall.b.y - wall.a.y;
    const double det = ex * dy - ey * dx;
    if (det == 0) continue;
    const double ax = wall.a.x - T_room_lidar.x, ay = wall.a.y - T_room_lidar.y;
    const double range = (ex * ay - ey * ax) / det, along = (dx * ay - dy * ax) / det;
    if (range > 0 && along >= 0 && along <= 1) nearest = std::min(nearest, range);
  }
  return nearest;
}

/// An exact scan of `beams` beams over `fov_deg`, first to last.
inline lidar::Scan scanRoom(const core::Pose2& T_room_robot, double time_s, int beams = 181,
                            double fov_deg = 180) {
  lidar::Scan scan;
  scan.time_s = time_s;
  scan.step_rad = core::degToRad(fov_deg) / (beams - 1);
  scan.first_angle_rad = -core::degToRad(fov_deg) / 2;
  scan.max_range_m = 20;
  scan.range_sigma_m = 0.01;
  const auto walls = smallRoom();
  for (int i = 0; i < beams; ++i)
    scan.ranges_m.push_back(
        static_cast<float>(castRay(walls, T_room_robot, scan.angle(static_cast<size_t>(i)))));
  return scan;
}

/// A drive through the room with exact scans and odometry that turns 3 % too far and drives 2 % too long.
struct Drive {
  std::vector<logs::LogEntry> entries;
  std::vector<core::Pose2> truth;  ///< T_start_robot at each entry
};

inline Drive driveThroughRoom(int steps = 60) {
  Drive drive;
  core::Pose2 T_room_robot{0, 0, -0.2}, T_odom_robot;
  const core::Pose2 T_room_start = T_room_robot;
  for (int i = 0; i < steps; ++i) {
    logs::LogEntry entry;
    core::Pose2 increment;
    if (i > 0) increment = {0.06, 0, (i / 12) % 2 == 0 ? 0.06 : -0.045};
    T_room_robot = T_room_robot * increment;
    entry.scan = scanRoom(T_room_robot, 1.6e9 + 0.2 * i);
    entry.T_previous_robot = {1.02 * increment.x, 0, 1.03 * increment.phi};
    T_odom_robot = T_odom_robot * entry.T_previous_robot;
    entry.T_odom_robot = T_odom_robot;
    entry.has_odometry = true;
    drive.entries.push_back(entry);
    drive.truth.push_back(core::between(T_room_start, T_room_robot));
  }
  return drive;
}

}  // namespace slam::mapping::test
