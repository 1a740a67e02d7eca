#include "libslam/rays/ray_caster.h"

#include <cmath>
#include <cstddef>

#include "libslam/core/numbers.h"
#include "libslam/rays/ray_walk.h"

namespace slam::rays {
namespace {

using core::kInfinity;

/// Distance in cells; may give up on hits beyond `limit` cells.
double castWithin(const world::CellMap& map, const core::Point2& origin, const core::Point2& direction,
                  double limit) {
  double distance = kInfinity;
  walkRay(map, origin, direction, limit, [&](const world::Cell* cell, const RayEntry& entry) {
    if (*cell != world::Cell::kOccupied) return true;
    distance = entry.distance();
    return false;
  });
  return distance;
}

double castFromCells(const world::CellMap& map, const core::Point2& origin, const core::Point2& direction,
                     double max_range_m) {
  return castInMetres(map, direction, max_range_m,
                      [&](const core::Point2& d, double limit) { return castWithin(map, origin, d, limit); });
}

}  // namespace

double castRayInCells(const world::CellMap& map, const core::Point2& origin, const core::Point2& direction) {
  return castWithin(map, origin, direction, kInfinity);
}

double castRay(const world::CellMap& map, const core::Point2& origin_world, double angle_rad,
               double max_range_m) {
  return castFromCells(map, world::pointToCells(map, origin_world), rayDirection(map, angle_rad),
                       max_range_m);
}

void castScan(const world::CellMap& map, const core::Pose2& T_world_lidar, const BeamTable& beams,
              double max_range_m, std::vector<float>& out_ranges_m) {
  const core::Point2 origin = world::pointToCells(map, core::position(T_world_lidar));
  const Rotation turn(T_world_lidar.phi - map.T_frame_raster.phi);
  out_ranges_m.resize(static_cast<size_t>(beams.size()));
  for (size_t i = 0; i < out_ranges_m.size(); ++i) {
    const core::Point2 direction = turn * core::Point2{beams.cosines()[i], beams.sines()[i]};
    out_ranges_m[i] = static_cast<float>(castFromCells(map, origin, direction, max_range_m));
  }
}

}  // namespace slam::rays
