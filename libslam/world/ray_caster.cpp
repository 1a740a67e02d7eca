#include "libslam/world/ray_caster.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace slam::world {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Below 1, so that a ray climbs at most one row per column even after rounding: the two products and sums of
// row(u + 1) - row(u) err by less than 2^-36 together while coordinates stay below 2^15 cells.
constexpr double kSteepest = 1.0 - 0x1.0p-36;

/// One axis of the plan, mirrored where the ray runs down it so that the ray always grows along it. Cell k of
/// the plan is cell -k - 1 of its mirror image: negation is exact, so the image costs no bit.
struct Axis {
  double origin;        ///< of the ray, cells
  double direction;     ///< cosine of the ray with the axis, >= 0
  int begin, end;       ///< cells begin .. end-1 exist
  std::ptrdiff_t step;  ///< from a cell to the next in Plan::cells
  std::ptrdiff_t zero;  ///< index contribution of cell 0
};

Axis growingAxis(double origin, double direction, int size, std::ptrdiff_t stride) {
  if (direction >= 0) return {origin, direction, 0, size, stride, 0};
  return {-origin, -direction, -size, 0, -stride, -stride};
}

/// Distance in cells, or infinity. `limit` only ends the walk early; the caller compares exactly.
double walk(const Plan& plan, const Axis& major, const Axis& minor, double limit) {
  const double floor_u = std::floor(major.origin), floor_v = std::floor(minor.origin);
  if (!(floor_u >= major.begin && floor_u < major.end && floor_v >= minor.begin && floor_v < minor.end))
    return kInfinity;
  int u = static_cast<int>(floor_u), v = static_cast<int>(floor_v);
  const Cell* cell = plan.cells.data() + major.zero + minor.zero + u * major.step + v * minor.step;
  if (*cell == Cell::kOccupied) return 0;

  const double slope = std::min(minor.direction / major.direction, kSteepest);
  // Two columns more than the range needs: rounding must not end a walk before the last hit within range.
  const double last_u = major.origin + limit * major.direction + 2;
  const int end_u = last_u < major.end ? static_cast<int>(last_u) : major.end;
  while (true) {
    const double row_at_far_side = minor.origin + (u + 1 - major.origin) * slope;
    if (row_at_far_side >= v + 1) {
      ++v;
      cell += minor.step;
      if (v >= minor.end) return kInfinity;
      if (*cell == Cell::kOccupied) {
        const double entry = (v - minor.origin) / minor.direction;
        // A ray almost parallel to the line meets it at an ill-conditioned place; column u still bounds it.
        const double nearest = std::max(0.0, u - major.origin) / major.direction;
        const double farthest = (u + 1 - major.origin) / major.direction;
        return std::min(std::max(entry, nearest), farthest);
      }
    }
    ++u;
    cell += major.step;
    if (u >= end_u) return kInfinity;
    if (*cell == Cell::kOccupied) return (u - major.origin) / major.direction;
  }
}

/// Distance in cells; may give up on hits beyond `limit` cells.
double castWithin(const Plan& plan, const core::Point2& origin, const core::Point2& direction, double limit) {
  const bool is_finite = std::isfinite(origin.x) && std::isfinite(origin.y) && std::isfinite(direction.x) &&
                         std::isfinite(direction.y);
  if (!is_finite) return kInfinity;
  const Axis x = growingAxis(origin.x, direction.x, plan.columns, 1);
  const Axis y = growingAxis(origin.y, direction.y, plan.rows, plan.columns);
  return x.direction >= y.direction ? walk(plan, x, y, limit) : walk(plan, y, x, limit);
}

double castFromCells(const Plan& plan, const core::Point2& origin, double angle_in_plan, double max_range_m) {
  const double limit_m = max_range_m > 0 ? max_range_m : kInfinity;
  const core::Point2 direction{std::cos(angle_in_plan), std::sin(angle_in_plan)};
  const double distance_m =
      plan.resolution_m * castWithin(plan, origin, direction, limit_m / plan.resolution_m);
  return distance_m <= limit_m ? distance_m : kInfinity;
}

}  // namespace

double castRayInCells(const Plan& plan, const core::Point2& origin, const core::Point2& direction) {
  return castWithin(plan, origin, direction, kInfinity);
}

double castRay(const Plan& plan, const core::Point2& origin_world, double angle_rad, double max_range_m) {
  return castFromCells(plan, worldToCells(plan, origin_world), angle_rad - plan.T_world_plan.phi,
                       max_range_m);
}

void castScan(const Plan& plan, const core::Pose2& T_world_lidar, double first_angle_rad, double step_rad,
              int beams, double max_range_m, std::vector<float>& out_ranges_m) {
  out_ranges_m.resize(beams > 0 ? static_cast<size_t>(beams) : 0);
  const core::Point2 origin = worldToCells(plan, core::position(T_world_lidar));
  for (int i = 0; i < beams; ++i) {
    const double angle_rad = T_world_lidar.phi + first_angle_rad + i * step_rad;
    out_ranges_m[static_cast<size_t>(i)] =
        static_cast<float>(castFromCells(plan, origin, angle_rad - plan.T_world_plan.phi, max_range_m));
  }
}

}  // namespace slam::world
