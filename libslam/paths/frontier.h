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

/// The same where the frontier cells are known: ascending, all of them, and no others.
std::vector<Frontier> findFrontiers(const FreeSpace& space, const std::vector<std::size_t>& cells,
                                    std::size_t min_cells);

/// Those of all frontiers, ascending, not told apart: for who needs no more, at a part of the time.
std::vector<std::size_t> frontierCells(const FreeSpace& space);

/// Those of the cells that are frontier cells of the map. Where nothing has become free or unknown since they
/// were all of them, these are all. REQUIRES no cell on the raster's edge.
std::vector<std::size_t> frontierCellsAmong(const FreeSpace& space, const std::vector<std::size_t>& cells);

/// The frontier cells of a map that grows, kept from one state of it to the next: only rows with changed
/// cells, and those beside them, are looked at anew.
class FrontierCells {
 public:
  /// `changed` holds every cell whose state is another than at the call before. The first time, and of a map
  /// of another size, all are looked at.
  void update(const FreeSpace& space, const CellBlock& changed);
  /// Ascending.
  const std::vector<std::size_t>& cells() const { return cells_; }

 private:
  std::vector<std::size_t> cells_;
  int columns_ = 0, rows_ = 0;  ///< of the map that they are of
};

/// True when the cell is free and has an unknown cell to the left, right, above or below.
bool isFrontierCell(const FreeSpace& space, std::size_t cell);

}  // namespace slam::paths
