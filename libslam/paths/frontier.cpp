#include "libslam/paths/frontier.h"

#include <algorithm>

namespace slam::paths {
namespace {

std::vector<std::size_t> frontierCells(const FreeSpace& space) {
  std::vector<std::size_t> cells;
  const int width = space.columns;
  std::vector<std::uint8_t> hit(static_cast<std::size_t>(width));
  for (int row = 1; row + 1 < space.rows; ++row) {
    const std::uint8_t* const here = space.state.data() + space.index(0, row);
    unsigned any = 0;
    // Without a branch, so that it vectorises: most rows of a map hold few frontier cells or none.
    for (int i = 1; i + 1 < width; ++i) {
      const auto around =
          static_cast<std::uint8_t>(here[i - 1] | here[i + 1] | here[i - width] | here[i + width]);
      hit[static_cast<std::size_t>(i)] =
          static_cast<std::uint8_t>((here[i] == kFreeCell) & ((around & kUnknownCell) != 0));
      any |= hit[static_cast<std::size_t>(i)];
    }
    if (!any) continue;
    for (int i = 1; i + 1 < width; ++i)
      if (hit[static_cast<std::size_t>(i)]) cells.push_back(space.index(i, row));
  }
  return cells;
}

}  // namespace

bool isFrontierCell(const FreeSpace& space, std::size_t cell) {
  const auto width = static_cast<std::size_t>(space.columns);
  const std::uint8_t* const here = space.state.data() + cell;
  return *here == kFreeCell && ((here[-1] | here[1] | *(here - width) | here[width]) & kUnknownCell) != 0;
}

std::vector<Frontier> findFrontiers(const FreeSpace& space, std::size_t min_cells) {
  const auto cells = frontierCells(space);
  // Neighbours are looked up in the sorted list itself: a raster of marks would cost more than all the rest.
  std::vector<char> taken(cells.size(), 0);
  std::vector<Frontier> frontiers;
  std::vector<std::size_t> open;
  const auto width = static_cast<std::size_t>(space.columns);
  const auto take = [&](std::size_t first, std::size_t last) {  // cells first..last that are in the list
    auto it = std::lower_bound(cells.begin(), cells.end(), first);
    for (; it != cells.end() && *it <= last; ++it) {
      const auto i = static_cast<std::size_t>(it - cells.begin());
      if (taken[i]) continue;
      taken[i] = 1;
      open.push_back(i);
    }
  };
  for (std::size_t seed = 0; seed < cells.size(); ++seed) {
    if (taken[seed]) continue;
    Frontier frontier;
    take(cells[seed], cells[seed]);
    while (!open.empty()) {
      const std::size_t cell = cells[open.back()];
      open.pop_back();
      frontier.cells.push_back(cell);
      for (const std::size_t row : {cell - width, cell, cell + width}) take(row - 1, row + 1);
    }
    if (frontier.cells.size() < min_cells) continue;
    std::sort(frontier.cells.begin(), frontier.cells.end());
    frontiers.push_back(std::move(frontier));
  }
  return frontiers;
}

}  // namespace slam::paths
