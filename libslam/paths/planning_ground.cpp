#include "libslam/paths/planning_ground.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/error.h"

namespace slam::paths {
namespace {

// From 15 cells on best_cell would overflow.
constexpr int kMostCellsPerNode = 15;

std::uint8_t obstaclesOf(const PlannerOptions& options) {
  return static_cast<std::uint8_t>(options.optimistic ? kOccupiedCell : kOccupiedCell | kUnknownCell);
}

int cellsPerNode(const PlannerOptions& options, double resolution_m) {
  return std::clamp(static_cast<int>(std::lround(options.node_m / resolution_m)), 1, kMostCellsPerNode);
}

}  // namespace

std::int16_t clearingSquare(double radius_m, double resolution_m) {
  const double cells = radius_m / resolution_m + 0.5;
  return static_cast<std::int16_t>(std::ceil(cells * cells - 1e-9));
}

PlanningNodes::PlanningNodes(const FreeSpace& space, const PlannerOptions& options) {
  if (!(options.radius_m > 0) || !(options.comfort_m >= options.radius_m) || !(options.node_m > 0))
    throw core::ContractError("PathPlanner: expected 0 < radius_m <= comfort_m and a positive node_m");
  per_node = cellsPerNode(options, space.resolution_m);
  admitted = clearingSquare(options.radius_m, space.resolution_m);
  comfort = clearingSquare(options.comfort_m, space.resolution_m);
  reach_ = static_cast<int>(std::ceil(std::sqrt(comfort))) + 1;
  obstacles_ = obstaclesOf(options);
  cell_columns_ = space.columns;
  cell_rows_ = space.rows;
  clearance = squaredClearance(space, obstacles_, reach_);
  factor_of.assign(static_cast<std::size_t>(reach_ * reach_) + 1, 0);
  for (auto d = static_cast<std::size_t>(admitted); d < factor_of.size(); ++d) {
    const double near = std::sqrt(admitted), far = std::sqrt(comfort), here = std::sqrt(d);
    const double closeness = far > near ? std::clamp((far - here) / (far - near), 0.0, 1.0) : 0.0;
    factor_of[d] = static_cast<std::uint8_t>(std::lround(kOne + closeness * (kDearest - kOne)));
  }
  columns = (space.columns + per_node - 1) / per_node + 2;
  rows = (space.rows + per_node - 1) / per_node + 2;
  const auto count = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  factor.assign(count, 0);
  best_cell.assign(count, 0);
  is_free.assign(count, 0);
  makeNodes(space, {0, 0, space.columns, space.rows});
}

bool PlanningNodes::suits(const FreeSpace& space, const PlannerOptions& options) const {
  return cell_columns_ == space.columns && cell_rows_ == space.rows &&
         per_node == cellsPerNode(options, space.resolution_m) && obstacles_ == obstaclesOf(options) &&
         admitted == clearingSquare(options.radius_m, space.resolution_m) &&
         comfort == clearingSquare(options.comfort_m, space.resolution_m);
}

void PlanningNodes::refresh(const FreeSpace& space, const CellBlock& changed) {
  const CellBlock near = grown(changed, reach_, space), seen = grown(near, reach_, space);
  const auto part = squaredClearance(cutOut(space, seen), obstacles_, reach_);
  const auto width = static_cast<std::size_t>(near.columns());
  for (int row = near.first_row; row < near.last_row; ++row)
    std::copy_n(part.data() + static_cast<std::size_t>(row - seen.first_row) * seen.columns() +
                    (near.first_column - seen.first_column),
                width, clearance.data() + space.index(near.first_column, row));
  makeNodes(space, near);
}

/// Those that any cell of the block belongs to.
void PlanningNodes::makeNodes(const FreeSpace& space, const CellBlock& block) {
  const int first = block.first_column / per_node, last = (block.last_column - 1) / per_node;
  std::vector<std::int16_t> best(static_cast<std::size_t>(columns));
  for (int row = block.first_row / per_node; row <= (block.last_row - 1) / per_node; ++row) {
    std::fill(best.begin(), best.end(), std::int16_t{-1});
    const std::size_t row_start = static_cast<std::size_t>(row + 1) * static_cast<std::size_t>(columns);
    for (int dr = 0; dr < per_node; ++dr) {
      const int cell_row = row * per_node + dr;
      if (cell_row >= cell_rows_) break;
      const std::int16_t* here =
          clearance.data() + static_cast<std::size_t>(cell_row) * static_cast<std::size_t>(cell_columns_);
      for (int node = first + 1, cell = first * per_node; node <= last + 1; ++node)
        for (int dc = 0; dc < per_node && cell < cell_columns_; ++dc, ++cell)
          if (here[cell] > best[static_cast<std::size_t>(node)]) {
            best[static_cast<std::size_t>(node)] = here[cell];
            best_cell[row_start + static_cast<std::size_t>(node)] =
                static_cast<std::uint8_t>(dr * per_node + dc);
          }
    }
    for (int node = first + 1; node <= last + 1; ++node) {
      const std::size_t at = row_start + static_cast<std::size_t>(node);
      factor[at] = factor_of[static_cast<std::size_t>(best[static_cast<std::size_t>(node)])];
      const int column = (node - 1) * per_node + best_cell[at] % per_node;
      is_free[at] = space.state[space.index(column, row * per_node + best_cell[at] / per_node)] == kFreeCell;
    }
  }
}

void PlanningGround::update(const FreeSpace& map, const PlannerOptions& options) {
  const bool is_new = !nodes_ || !nodes_->suits(map, options);
  const auto changed = is_new ? CellBlock{} : changedCells(map_, map);
  // The map may have moved as a whole, and its cells be the same: its frame is taken over in any case.
  const auto takeFrame = [&](FreeSpace& to) {
    to.x_min_m = map.x_min_m, to.y_min_m = map.y_min_m;
    to.resolution_m = map.resolution_m, to.known = map.known;
  };
  if (!is_new) {
    takeFrame(map_), takeFrame(space_);
    if (changed.isEmpty()) return;
  }
  if (is_new || 2 * changed.cells() > map.state.size()) {
    map_ = space_ = map;
    closeGaps(space_);
    nodes_ = std::make_shared<PlanningNodes>(space_, options);
    return;
  }
  paste(map, changed, map_);
  // A gap closes by its neighbours, which are read one farther on.
  const CellBlock near = grown(changed, 1, map), seen = grown(changed, 2, map);
  FreeSpace part = cutOut(map, seen);
  closeGaps(part);
  for (int row = near.first_row; row < near.last_row; ++row)
    std::copy_n(part.state.data() + part.index(near.first_column - seen.first_column, row - seen.first_row),
                near.columns(), space_.state.data() + space_.index(near.first_column, row));
  if (nodes_.use_count() > 1) nodes_ = std::make_shared<PlanningNodes>(*nodes_);
  nodes_->refresh(space_, near);
}

}  // namespace slam::paths
