#include <algorithm>
#include <cmath>
#include <limits>

#include "libslam/metrics/map_score.h"

namespace slam::metrics {
namespace {

constexpr double kThinDistance_m = 0.1;
constexpr double kThinAngle_rad = core::degToRad(5);

/// One byte per cell: std::vector<bool> is too slow to mark 10^8 cells in.
struct Marks {
  std::vector<unsigned char> wall, free;
};

bool worthCasting(const core::Pose2& last_used, const core::Pose2& pose) {
  return core::distance(last_used, pose) > kThinDistance_m ||
         std::abs(core::angleDifference(last_used.phi, pose.phi)) > kThinAngle_rad;
}

/// One axis of the plan in cells, mirrored where the ray runs down it, so that the ray grows along it: a
/// coordinate is negated and cell k becomes cell -k - 1, both without rounding.
struct GrowingAxis {
  double origin, direction;
  int begin, end;
  std::ptrdiff_t stride, offset;  ///< cell k stands at k * stride + offset of the plan's cells

  GrowingAxis(double ray_origin, double cosine, int size, std::ptrdiff_t plan_stride)
      : origin(cosine < 0 ? -ray_origin : ray_origin),
        direction(std::abs(cosine)),
        begin(cosine < 0 ? -size : 0),
        end(begin + size),
        stride(cosine < 0 ? -plan_stride : plan_stride),
        offset(cosine < 0 ? -plan_stride : 0) {}
  int cellOfOrigin() const { return static_cast<int>(std::floor(origin)); }
  bool contains(int cell) const { return cell >= begin && cell < end; }
};

/// Marks what one ray sees, by the walk of world::castRay() (its header states the arithmetic); all in cells.
/// The origin lies in the plan.
void markRay(const world::Plan& plan, const core::Point2& origin, double angle_in_plan,
             double max_range_cells, Marks& marks) {
  const GrowingAxis x(origin.x, std::cos(angle_in_plan), plan.columns, 1);
  const GrowingAxis y(origin.y, std::sin(angle_in_plan), plan.rows, plan.columns);
  const GrowingAxis& major = x.direction >= y.direction ? x : y;
  const GrowingAxis& minor = x.direction >= y.direction ? y : x;
  const double slope = std::min(minor.direction / major.direction, 1 - std::ldexp(1.0, -36));
  const auto seeAndPass = [&](int u, int v) {
    const auto cell = static_cast<size_t>(u * major.stride + major.offset + v * minor.stride + minor.offset);
    if (plan.cells[cell] == world::Cell::kOccupied) marks.wall[cell] = 1;
    if (plan.cells[cell] == world::Cell::kFree) marks.free[cell] = 1;
    return plan.cells[cell] != world::Cell::kOccupied;
  };

  int u = major.cellOfOrigin(), v = minor.cellOfOrigin();
  if (!major.contains(u) || !minor.contains(v) || !seeAndPass(u, v)) return;
  while (true) {
    if (minor.origin + (u + 1 - major.origin) * slope >= v + 1) {
      ++v;
      if (v - minor.origin > max_range_cells * minor.direction) return;
      if (v >= minor.end || !seeAndPass(u, v)) return;
    }
    ++u;
    if (u - major.origin > max_range_cells * major.direction) return;
    if (u >= major.end || !seeAndPass(u, v)) return;
  }
}

}  // namespace

SeenMask seenCells(const world::Plan& plan, const core::Trajectory& truth, const core::Pose2& T_robot_lidar,
                   double first_angle_rad, double step_rad, int beams, double max_range_m) {
  Marks marks;
  marks.wall.assign(plan.cells.size(), 0);
  marks.free.assign(plan.cells.size(), 0);
  const double max_range_cells =
      max_range_m > 0 ? max_range_m / plan.resolution_m : std::numeric_limits<double>::infinity();
  const core::Pose2* last_used = nullptr;
  for (const auto& stamped : truth) {
    if (!core::isFinite(stamped.pose)) continue;
    if (last_used && &stamped != &truth.back() && !worthCasting(*last_used, stamped.pose)) continue;
    last_used = &stamped.pose;
    const auto T_world_lidar = stamped.pose * T_robot_lidar;
    const auto origin = world::worldToCells(plan, core::position(T_world_lidar));
    // Not !contains(int, int): a coordinate far outside would overflow the conversion.
    if (!(origin.x >= 0 && origin.y >= 0 && origin.x < plan.columns && origin.y < plan.rows)) continue;
    if (plan.at(static_cast<int>(origin.x), static_cast<int>(origin.y)) == world::Cell::kOccupied) continue;
    for (int beam = 0; beam < beams; ++beam)
      markRay(plan, origin, T_world_lidar.phi + first_angle_rad + beam * step_rad - plan.T_world_plan.phi,
              max_range_cells, marks);
  }
  SeenMask seen;
  seen.columns = plan.columns;
  seen.rows = plan.rows;
  seen.wall.assign(marks.wall.begin(), marks.wall.end());
  seen.free.assign(marks.free.begin(), marks.free.end());
  return seen;
}

}  // namespace slam::metrics
