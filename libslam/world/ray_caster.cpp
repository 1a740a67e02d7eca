#include "libslam/world/ray_caster.h"

#include <cmath>
#include <cstddef>
#include <limits>

#include "libslam/world/ray_walk.h"

namespace slam::world {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Distance in cells; may give up on hits beyond `limit` cells.
double castWithin(const Plan& plan, const core::Point2& origin, const core::Point2& direction, double limit) {
  double distance = kInfinity;
  walkRay(plan, origin, direction, limit, [&](const Cell* cell, const RayEntry& entry) {
    if (*cell != Cell::kOccupied) return true;
    distance = entry.distance();
    return false;
  });
  return distance;
}

double castFromCells(const Plan& plan, const core::Point2& origin, double angle_rad, double max_range_m) {
  return castInMetres(plan, angle_rad, max_range_m, [&](const core::Point2& direction, double limit) {
    return castWithin(plan, origin, direction, limit);
  });
}

}  // namespace

double castRayInCells(const Plan& plan, const core::Point2& origin, const core::Point2& direction) {
  return castWithin(plan, origin, direction, kInfinity);
}

double castRay(const Plan& plan, const core::Point2& origin_world, double angle_rad, double max_range_m) {
  return castFromCells(plan, worldToCells(plan, origin_world), angle_rad, max_range_m);
}

void castScan(const Plan& plan, const core::Pose2& T_world_lidar, double first_angle_rad, double step_rad,
              int beams, double max_range_m, std::vector<float>& out_ranges_m) {
  out_ranges_m.resize(beams > 0 ? static_cast<size_t>(beams) : 0);
  const core::Point2 origin = worldToCells(plan, core::position(T_world_lidar));
  for (int i = 0; i < beams; ++i) {
    const double angle_rad = T_world_lidar.phi + first_angle_rad + i * step_rad;
    out_ranges_m[static_cast<size_t>(i)] =
        static_cast<float>(castFromCells(plan, origin, angle_rad, max_range_m));
  }
}

}  // namespace slam::world
