#pragma once
#include <cstddef>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/paths/free_space.h"

namespace slam::paths {

/// Free cells side by side that have an unknown cell to the left, right, above or below: the border between
/// what is known to be free and what is not known (Yamauchi, "A frontier-based approach for autonomous
/// exploration", CIRA 1997).
struct Frontier {
  std::vector<std::size_t> cells;  ///< ascending indices into FreeSpace::state, 8-connected
};

/// All frontiers of at least min_cells cells, by their first cell. The raster's edge counts as unknown
/// beyond.
std::vector<Frontier> findFrontiers(const FreeSpace& space, std::size_t min_cells);

/// Those of all frontiers, ascending, not told apart: for who needs no more, at a part of the time.
std::vector<std::size_t> frontierCells(const FreeSpace& space);

/// True when the cell is free and has an unknown cell to the left, right, above or below.
bool isFrontierCell(const FreeSpace& space, std::size_t cell);

}  // namespace slam::paths
