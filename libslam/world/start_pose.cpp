#include <cstdint>
#include <limits>

#include "libslam/world/clearance.h"
#include "libslam/world/plan.h"
#include "libslam/world/region.h"

namespace slam::world {
std::optional<core::Pose2> findStartPose(const Plan& plan, double clearance_m) {
  // A hair more than asked for, so that the pose keeps its clearance after rounding to metres and back.
  const double radius = clearance_m / plan.resolution_m + 1e-6;
  if (!(radius >= 0)) return std::nullopt;
  const std::vector<size_t> region = largestRegion(plan.columns, admissibleCells(plan, radius));
  if (region.empty()) return std::nullopt;

  std::int64_t sum_columns = 0, sum_rows = 0;
  for (const size_t index : region) {
    sum_columns += static_cast<std::int64_t>(index) % plan.columns;
    sum_rows += static_cast<std::int64_t>(index) / plan.columns;
  }
  const auto count = static_cast<double>(region.size());
  const double mean_column = static_cast<double>(sum_columns) / count;
  const double mean_row = static_cast<double>(sum_rows) / count;
  double nearest = std::numeric_limits<double>::infinity();
  core::Point2 centre;
  for (const size_t index : region) {
    const auto column = static_cast<int>(index % static_cast<size_t>(plan.columns));
    const auto row = static_cast<int>(index / static_cast<size_t>(plan.columns));
    const double dx = column - mean_column, dy = row - mean_row;
    if (dx * dx + dy * dy >= nearest) continue;
    nearest = dx * dx + dy * dy;
    centre = {column + 0.5, row + 0.5};
  }
  const core::Point2 p_world = cellsToPoint(plan, centre);
  return core::Pose2{p_world.x, p_world.y, 0};
}

}  // namespace slam::world
