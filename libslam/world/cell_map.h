#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::world {

enum class Cell : std::uint8_t { kFree = 0, kOccupied = 1, kUnknown = 2 };

/// A raster of cells in metres: the true world's (a Plan is one), or an estimated map of it. Cell (column,
/// row) covers [column, column + 1) x [row, row + 1) in units of resolution_m in the raster's frame; row 0 is
/// at the bottom (y up), the frame's origin is the lower left corner of cell (0, 0). T_frame_raster places
/// the raster in the map's own frame (ROS: `origin`, with yaw), which is the world for a Plan and the map
/// frame for an estimate.
struct CellMap {
  std::string name;  ///< file name without folder and suffix, for tables
  int columns = 0, rows = 0;
  double resolution_m = 0.05;
  core::Pose2 T_frame_raster;
  std::vector<Cell> cells;  ///< row-major, row 0 first; columns * rows of them

  Cell at(int column, int row) const { return cells[static_cast<std::size_t>(row) * columns + column]; }
  bool contains(int column, int row) const {
    return column >= 0 && row >= 0 && column < columns && row < rows;
  }
};

/// Cell coordinates (column, row as reals) of a point in the map's own frame, and back.
core::Point2 pointToCells(const CellMap& map, const core::Point2& p_frame);
core::Point2 cellsToPoint(const CellMap& map, const core::Point2& cell);

/// The cells of a file that loadPlan() reads (plan.h), with its errors; but an estimated map may be without
/// walls or without free space: a naive one claims no free space, a diverged one no walls. In plan.cpp.
CellMap loadCellMap(const std::string& path);

/// As savePlan(), of cells alone. In plan.cpp.
void saveCellMap(const CellMap& map, const std::string& yaml_path);

}  // namespace slam::world
