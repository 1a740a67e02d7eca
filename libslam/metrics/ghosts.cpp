#include "libslam/metrics/ghosts.h"

#include <cmath>
#include <limits>

#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/core/rigid_motion2.h"

namespace slam::metrics {
namespace {

constexpr double kRounding_m = 1e-9;

/// Marks the cells whose centre lies within `reach_m` of a point, in the plan's own cells.
void markAround(const world::Plan& plan, const core::Point2& p_cells, double reach_m,
                std::vector<unsigned char>& marks) {
  const double reach = (reach_m + kRounding_m) / plan.resolution_m;
  if (!(p_cells.x > -reach && p_cells.y > -reach && p_cells.x < plan.columns + reach &&
        p_cells.y < plan.rows + reach))
    return;
  const int last_row = static_cast<int>(std::floor(p_cells.y + reach)),
            last_column = static_cast<int>(std::floor(p_cells.x + reach));
  for (int row = static_cast<int>(std::floor(p_cells.y - reach)); row <= last_row; ++row)
    for (int column = static_cast<int>(std::floor(p_cells.x - reach)); column <= last_column; ++column) {
      const double dx = column + 0.5 - p_cells.x, dy = row + 0.5 - p_cells.y;
      if (plan.contains(column, row) && dx * dx + dy * dy <= reach * reach)
        marks[static_cast<size_t>(row) * plan.columns + column] = 1;
    }
}

/// The ground that counts: 1.
std::vector<unsigned char> groundOf(const world::Plan& plan, const SeenMask& seen,
                                    const std::vector<core::Point2>& people, double tolerance_m) {
  std::vector<unsigned char> ground(plan.cells.size(), 0), near_wall(plan.cells.size(), 0);
  // Somebody who waits stands in one place for many scans.
  core::Point2 last{std::numeric_limits<double>::infinity(), 0};
  for (const auto& p : people) {
    if (p.x == last.x && p.y == last.y) continue;
    last = p;
    markAround(plan, world::pointToCells(plan, p), kPersonReach_m, ground);
  }
  for (int row = 0; row < plan.rows; ++row)
    for (int column = 0; column < plan.columns; ++column)
      if (plan.at(column, row) == world::Cell::kOccupied)
        markAround(plan, {column + 0.5, row + 0.5}, tolerance_m, near_wall);
  for (size_t cell = 0; cell < ground.size(); ++cell)
    if (!seen.free[cell] || near_wall[cell]) ground[cell] = 0;
  return ground;
}

}  // namespace

double ghostShare(const world::Plan& plan, const SeenMask& seen, const std::vector<core::Point2>& people,
                  const world::CellMap& map, const core::Pose2& T_world_map, double tolerance_m) {
  if (seen.columns != plan.columns || seen.rows != plan.rows || seen.free.size() != plan.cells.size())
    throw core::ContractError("ghostShare: the mask is not the plan's");
  if (!(tolerance_m >= 0)) throw core::ContractError("ghostShare: tolerance_m must not be below 0");
  using core::kNaN;
  if (!core::isFinite(T_world_map)) return kNaN;
  const auto ground = groundOf(plan, seen, people, tolerance_m);
  size_t cells = 0, ghosts = 0;
  for (const unsigned char is_ground : ground) cells += is_ground;
  if (cells == 0) return kNaN;
  const core::RigidMotion2 T_plan_map(core::between(plan.T_frame_raster, T_world_map * map.T_frame_raster));
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column) {
      if (map.at(column, row) != world::Cell::kOccupied) continue;
      const core::Point2 p =
          T_plan_map * core::Point2{(column + 0.5) * map.resolution_m, (row + 0.5) * map.resolution_m};
      const double plan_column = std::floor(p.x / plan.resolution_m),
                   plan_row = std::floor(p.y / plan.resolution_m);
      if (!(plan_column >= 0 && plan_row >= 0 && plan_column < plan.columns && plan_row < plan.rows))
        continue;
      ghosts += ground[static_cast<size_t>(plan_row) * plan.columns + static_cast<size_t>(plan_column)];
    }
  const double ratio = map.resolution_m / plan.resolution_m;
  return static_cast<double>(ghosts) * ratio * ratio / static_cast<double>(cells);
}

}  // namespace slam::metrics
