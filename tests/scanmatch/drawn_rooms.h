#pragma once
#include <cmath>
#include <limits>
#include <vector>

#include "libslam/core/random.h"
#include "libslam/lidar/scan.h"

namespace slam::scanmatch_test {

struct Wall {
  core::Point2 a, b;
};

/// Four walls.
inline std::vector<Wall> rectangle(double x0, double y0, double x1, double y1) {
  return {{{x0, y0}, {x1, y0}}, {{x1, y0}, {x1, y1}}, {{x1, y1}, {x0, y1}}, {{x0, y1}, {x0, y0}}};
}

/// Distance to the first wall along a ray, infinity without one: exact, free of any raster.
inline double rayToWalls(const std::vector<Wall>& walls, const core::Point2& from, double angle) {
  const double dx = std::cos(angle), dy = std::sin(angle);
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& wall : walls) {
    const double ex = wall.b.x - wall.a.x, ey = wall.b.y - wall.a.y;
    const double cross = dx * ey - dy * ex;
    if (std::abs(cross) < 1e-12) continue;
    const double px = wall.a.x - from.x, py = wall.a.y - from.y;
    const double along = (px * ey - py * ex) / cross, share = (px * dy - py * dx) / cross;
    if (along > 1e-9 && share >= 0 && share <= 1 && along < nearest) nearest = along;
  }
  return nearest;
}

struct Lidar {
  int beams = 181;
  double fov_rad = core::kPi, max_range_m = 20, noise_m = 0.01;
  core::Pose2 T_robot_lidar;
};

inline lidar::Scan look(const std::vector<Wall>& walls, const core::Pose2& T_world_robot, const Lidar& lidar,
                        core::RandomStream& chance) {
  lidar::Scan scan;
  scan.first_angle_rad = -lidar.fov_rad / 2;
  scan.step_rad = lidar.fov_rad / (lidar.beams - 1);
  scan.max_range_m = lidar.max_range_m;
  scan.T_robot_lidar = lidar.T_robot_lidar;
  const core::Pose2 T_world_lidar = T_world_robot * lidar.T_robot_lidar;
  for (int i = 0; i < lidar.beams; ++i) {
    const double range_m = rayToWalls(walls, core::position(T_world_lidar),
                                      T_world_lidar.phi + scan.angle(static_cast<size_t>(i)));
    const double read_m = range_m + lidar.noise_m * chance.normal();
    scan.ranges_m.push_back(range_m < lidar.max_range_m ? static_cast<float>(read_m) : lidar::kNoReturn);
  }
  return scan;
}

/// All around, 5 cm apart.
inline std::vector<core::Pose2> aFewPosesAround(double x) {
  std::vector<core::Pose2> poses;
  poses.reserve(12);
  for (int i = 0; i < 12; ++i) poses.push_back({x + 0.05 * i, 0.02 * i, i * core::kPi / 6});
  return poses;
}

}  // namespace slam::scanmatch_test
