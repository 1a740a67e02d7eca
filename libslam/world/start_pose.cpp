#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "libslam/world/plan.h"
#include "libslam/world/region.h"

namespace slam::world {
namespace {

/// Rows up or down to the nearest occupied cell of the same column; kFar where there is none.
constexpr int kFar = std::numeric_limits<int>::max();

std::vector<int> rowsToObstacle(const Plan& plan) {
  std::vector<int> rows(plan.cells.size(), kFar);
  for (int column = 0; column < plan.columns; ++column) {
    const auto sweep = [&](int first, int last, int step) {
      int distance = kFar;
      for (int row = first; row != last; row += step) {
        if (plan.at(column, row) == Cell::kOccupied)
          distance = 0;
        else if (distance != kFar)
          ++distance;
        int& nearest = rows[static_cast<size_t>(row) * plan.columns + column];
        nearest = std::min(nearest, distance);
      }
    };
    sweep(0, plan.rows, 1);
    sweep(plan.rows - 1, -1, -1);
  }
  return rows;
}

/// Free cells around whose centre a disc of `radius` cells touches no occupied square and stays in the plan:
/// the two passes of a distance transform, the second only as wide as the disc.
std::vector<char> admissibleCells(const Plan& plan, double radius) {
  const std::vector<int> rows_to_obstacle = rowsToObstacle(plan);
  const auto gapOfOffset = [](int offset) { return std::max(0.0, std::abs(offset) - 0.5); };
  const int reach = static_cast<int>(std::ceil(std::min(radius + 0.5, 1.0 * plan.columns)));
  std::vector<char> admissible(plan.cells.size(), 0);
  for (int row = 0; row < plan.rows; ++row) {
    const bool row_fits = row + 0.5 - radius >= 0 && row + 0.5 + radius <= plan.rows;
    for (int column = 0; row_fits && column < plan.columns; ++column) {
      const bool column_fits = column + 0.5 - radius >= 0 && column + 0.5 + radius <= plan.columns;
      if (!column_fits || plan.at(column, row) != Cell::kFree) continue;
      bool clear = true;
      const int last = std::min(plan.columns - 1, column + reach);
      for (int other = std::max(0, column - reach); clear && other <= last; ++other) {
        const int offset = rows_to_obstacle[static_cast<size_t>(row) * plan.columns + other];
        if (offset == kFar) continue;
        const double dx = gapOfOffset(other - column), dy = gapOfOffset(offset);
        clear = dx * dx + dy * dy > radius * radius;
      }
      admissible[static_cast<size_t>(row) * plan.columns + column] = clear;
    }
  }
  return admissible;
}

}  // namespace

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
  const core::Point2 p_world = cellsToWorld(plan, centre);
  return core::Pose2{p_world.x, p_world.y, 0};
}

}  // namespace slam::world
