#include <algorithm>
#include <cstddef>
#include <limits>

#include "libslam/metrics/map_score.h"
#include "libslam/metrics/view_thinning.h"
#include "libslam/rays/ray_walk.h"

namespace slam::metrics {
namespace {

/// One byte per cell: std::vector<bool> is too slow to mark 10^8 cells in.
struct Marks {
  std::vector<unsigned char> wall, free;
};

/// Marks what one ray sees; all in cells.
void markRay(const world::Plan& plan, const core::Point2& origin, double angle_in_plan,
             double max_range_cells, Marks& marks) {
  const core::Point2 direction = core::polar(1, angle_in_plan);
  const world::Cell* cells = plan.cells.data();
  unsigned char *walls = marks.wall.data(), *free = marks.free.data();
  rays::walkRay(plan, origin, direction, max_range_cells,
                [=](const world::Cell* cell, const rays::RayEntry& entry) {
                  if (!entry.isWithin(max_range_cells)) return false;
                  if (*cell == world::Cell::kOccupied) walls[cell - cells] = 1;
                  if (*cell == world::Cell::kFree) free[cell - cells] = 1;
                  return *cell != world::Cell::kOccupied;
                });
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
    if (last_used && &stamped != &truth.back() && !isNewView(*last_used, stamped.pose)) continue;
    last_used = &stamped.pose;
    const auto T_world_lidar = stamped.pose * T_robot_lidar;
    const auto origin = world::pointToCells(plan, core::position(T_world_lidar));
    // Before the conversion to int, which a coordinate far outside would overflow.
    if (!(origin.x >= 0 && origin.y >= 0 && origin.x < plan.columns && origin.y < plan.rows)) continue;
    if (plan.at(static_cast<int>(origin.x), static_cast<int>(origin.y)) == world::Cell::kOccupied) continue;
    for (int beam = 0; beam < beams; ++beam)
      markRay(plan, origin, T_world_lidar.phi + first_angle_rad + beam * step_rad - plan.T_frame_raster.phi,
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
