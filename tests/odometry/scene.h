#pragma once
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <vector>

#include "libslam/core/random.h"
#include "libslam/lidar/scan.h"
#include "libslam/odometry/scan_odometry.h"

namespace slam::odometry::scenes {

/// A scene of straight walls, and an exact lidar in it: free of any raster, so that what is left is the
/// method.
struct Scene {
  struct Wall {
    core::Point2 from, to;
  };
  std::vector<Wall> walls;

  Scene& add(std::initializer_list<core::Point2> corners, bool closed = false) {
    const std::vector<core::Point2> c(corners);
    for (size_t i = 0; i + 1 < c.size(); ++i) walls.push_back({c[i], c[i + 1]});
    if (closed) walls.push_back({c.back(), c.front()});
    return *this;
  }
  Scene& box(double x0, double y0, double x1, double y1) {
    return add({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, true);
  }
};

struct Lidar {
  int beams = 360;
  double fov_rad = 2 * core::kPi;  ///< the full circle has no doubled beam
  double max_range_m = 30;
  double sigma_m = 0;
  double drop_out = 0;
  core::Pose2 T_robot_lidar;

  bool full() const { return fov_rad > 2 * core::kPi - 1e-9; }
  double step() const { return full() ? fov_rad / beams : fov_rad / (beams - 1); }
};

inline double castWall(const Scene::Wall& wall, const core::Point2& p, double angle_rad) {
  // p + r d = from + s e, solved by cross products.
  const double dx = std::cos(angle_rad), dy = std::sin(angle_rad);
  const double ex = wall.to.x - wall.from.x, ey = wall.to.y - wall.from.y;
  const double wx = wall.from.x - p.x, wy = wall.from.y - p.y;
  const double det = dx * ey - dy * ex;
  if (det == 0) return std::numeric_limits<double>::infinity();
  const double r = (wx * ey - wy * ex) / det, s = (wx * dy - wy * dx) / det;
  return r > 0 && s >= 0 && s <= 1 ? r : std::numeric_limits<double>::infinity();
}

/// What the lidar sees from a pose of the robot. `random` only where the lidar has noise or drop-outs.
inline lidar::Scan look(const Scene& scene, const core::Pose2& T_world_robot, const Lidar& lidar,
                        core::RandomStream* random = nullptr) {
  lidar::Scan scan;
  scan.first_angle_rad = -lidar.fov_rad / 2;
  scan.step_rad = lidar.step();
  scan.max_range_m = lidar.max_range_m;
  scan.range_sigma_m = lidar.sigma_m;
  scan.T_robot_lidar = lidar.T_robot_lidar;
  const core::Pose2 T_world_lidar = T_world_robot * lidar.T_robot_lidar;
  for (int i = 0; i < lidar.beams; ++i) {
    const double angle = T_world_lidar.phi + scan.angle(static_cast<size_t>(i));
    double range = std::numeric_limits<double>::infinity();
    for (const auto& wall : scene.walls)
      range = std::min(range, castWall(wall, core::position(T_world_lidar), angle));
    if (random) range += random->normal(lidar.sigma_m);
    float reading = range <= lidar.max_range_m ? static_cast<float>(range) : lidar::kNoReturn;
    if (random && random->chance(lidar.drop_out)) reading = lidar::kLostReading;
    scan.ranges_m.push_back(reading);
  }
  return scan;
}

inline std::unique_ptr<ScanOdometry> make(const char* method) {
  ScanOdometryOptions options;
  options.method = method;
  return makeScanOdometry(options);
}

/// The motion that a fresh odometry sees between two scans.
inline ScanMotion between(const char* method, const lidar::Scan& before, const lidar::Scan& after,
                          MotionKind kind = MotionKind::kUnknown) {
  const auto odometry = make(method);
  odometry->update(before, MotionKind::kUnknown);
  return odometry->update(after, kind);
}

/// A room without any symmetry: L-shaped, with a box and a slanted wall; about 8 x 6 m around the origin.
inline Scene oddRoom() {
  Scene scene;
  scene.add({{-3, -2}, {5, -2}, {5, 1}, {2.5, 1}, {2.5, 4}, {-1.5, 4}, {-3, 2.2}}, true);
  return scene.box(-1.6, -1.5, -1.1, -0.9);
}

/// Symmetric positive definite, by Sylvester's criterion.
inline bool isPositiveDefinite(const std::array<double, 9>& c) {
  const bool symmetric = c[1] == c[3] && c[2] == c[6] && c[5] == c[7];
  const double minor = c[0] * c[4] - c[1] * c[3];
  const double det = c[0] * (c[4] * c[8] - c[5] * c[7]) - c[1] * (c[3] * c[8] - c[5] * c[6]) +
                     c[2] * (c[3] * c[7] - c[4] * c[6]);
  return symmetric && c[0] > 0 && minor > 0 && det > 0;
}

/// e' C^-1 e by Cramer's rule.
inline double normalisedSquare(const std::array<double, 9>& c, const std::array<double, 3>& e) {
  const double a[3] = {c[4] * c[8] - c[5] * c[5], c[2] * c[5] - c[1] * c[8], c[1] * c[5] - c[2] * c[4]};
  const double d = c[0] * c[8] - c[2] * c[2], f = c[1] * c[2] - c[0] * c[5], g = c[0] * c[4] - c[1] * c[1];
  const double det = c[0] * a[0] + c[1] * a[1] + c[2] * a[2];
  return (e[0] * e[0] * a[0] + e[1] * e[1] * d + e[2] * e[2] * g + 2 * e[0] * e[1] * a[1] +
          2 * e[0] * e[2] * a[2] + 2 * e[1] * e[2] * f) /
         det;
}

}  // namespace slam::odometry::scenes
