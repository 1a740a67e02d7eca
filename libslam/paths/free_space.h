#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/gridmap/occupancy_raster.h"

namespace slam::paths {

/// What a cell of the map is, as bits so that neighbours can be combined with `|`.
enum CellState : std::uint8_t { kFreeCell = 0, kOccupiedCell = 1, kUnknownCell = 2 };

/// A map prepared for looking around and planning: one state per cell, with a border of one unknown cell all
/// round, because nothing is known beyond the raster's edge. Cells are numbered row by row from the bottom,
/// border included: index = row * columns + column, the raster's cell (c, r) is (c + 1, r + 1) here.
struct FreeSpace {
  int columns = 0, rows = 0;  ///< with the border
  double resolution_m = 0.05;
  double x_min_m = 0, y_min_m = 0;  ///< lower left corner of the border, map frame
  std::vector<std::uint8_t> state;  ///< CellState
  std::size_t known = 0;            ///< cells that are free or occupied

  std::size_t index(int column, int row) const { return static_cast<std::size_t>(row) * columns + column; }
  bool contains(int column, int row) const {
    return column >= 0 && row >= 0 && column < columns && row < rows;
  }
  int columnOf(double x_m) const { return static_cast<int>(std::floor((x_m - x_min_m) / resolution_m)); }
  int rowOf(double y_m) const { return static_cast<int>(std::floor((y_m - y_min_m) / resolution_m)); }
  core::Point2 centreOf(std::size_t cell) const {
    const auto width = static_cast<std::size_t>(columns);
    const std::size_t column = cell % width, row = cell / width;
    return {x_min_m + (static_cast<double>(column) + 0.5) * resolution_m,
            y_min_m + (static_cast<double>(row) + 0.5) * resolution_m};
  }
  /// Unknown beyond the raster.
  std::uint8_t at(const core::Point2& p_map) const {
    const int column = columnOf(p_map.x), row = rowOf(p_map.y);
    return contains(column, row) ? state[index(column, row)] : std::uint8_t{kUnknownCell};
  }
};

/// Reads the states by gridmap::kFreeBelow and kOccupiedAbove; NaN is unknown. Errors: occupancy.size() is
/// not columns * rows, a size is negative, the resolution is not positive (ContractError).
FreeSpace readFreeSpace(const gridmap::OccupancyRaster& map);

/// A block of cells, up to but without the last column and row.
struct CellBlock {
  int first_column = 0, first_row = 0, last_column = 0, last_row = 0;
  bool isEmpty() const { return last_column <= first_column || last_row <= first_row; }
  int columns() const { return last_column - first_column; }
  std::size_t cells() const {
    return isEmpty() ? 0
                     : static_cast<std::size_t>(columns()) * static_cast<std::size_t>(last_row - first_row);
  }
};
/// The least block that holds all cells whose states differ. REQUIRES two maps of equal size (ContractError).
CellBlock changedCells(const FreeSpace& a, const FreeSpace& b);
/// readFreeSpace() into a map that holds an earlier one, or nothing. Answers with the least block that holds
/// all cells whose states changed by that: of other sizes than before, the whole map.
CellBlock updateFreeSpace(const gridmap::OccupancyRaster& map, FreeSpace& space);
/// The least block that holds both.
CellBlock joined(const CellBlock& a, const CellBlock& b);
/// By so many cells to each side, as far as the map goes.
CellBlock grown(const CellBlock& block, int cells, const FreeSpace& space);
/// The states of the block as a map of its own, without a border; `known` is not counted.
FreeSpace cutOut(const FreeSpace& space, const CellBlock& block);
/// The states of the block, from a map into one of equal size.
void paste(const FreeSpace& from, const CellBlock& block, FreeSpace& to);

/// Squared distance in cells from the centre of every cell to the centre of the nearest cell whose state has
/// a bit of `obstacles`, exact up to reach_cells and reach_cells^2 beyond. In two passes as Felzenszwalb and
/// Huttenlocher, "Distance transforms of sampled functions" (Theory of Computing 8, 2012), but with the
/// second pass over a window, which the cap allows and which vectorises. REQUIRES 1 <= reach_cells <= 120
/// (ContractError). Cost: about 2 reach_cells integer operations per cell.
std::vector<std::int16_t> squaredClearance(const FreeSpace& space, std::uint8_t obstacles, int reach_cells);

/// The unknown cells that lie between two free ones (left and right, above and below, or on a diagonal) and
/// touch no occupied one become free: the gaps between the beams of a far look, thinner than anything that
/// could stop a robot.
void closeGaps(FreeSpace& space);

}  // namespace slam::paths
