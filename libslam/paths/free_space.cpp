#include "libslam/paths/free_space.h"

#include <algorithm>
#include <cstring>

#include "libslam/core/error.h"

namespace slam::paths {
namespace {

/// Distance along the column to the nearest obstacle, capped, by one sweep up and one down, whole rows at a
/// time so that both the memory and the vector units are used well.
std::vector<std::int16_t> columnDistance(const FreeSpace& space, std::uint8_t obstacles, int reach) {
  const auto width = static_cast<std::size_t>(space.columns);
  const auto cap = static_cast<std::int16_t>(reach);
  std::vector<std::int16_t> distance(space.state.size());
  for (std::size_t i = 0; i < distance.size(); ++i)
    distance[i] = space.state[i] & obstacles ? std::int16_t{0} : cap;
  const auto relax = [&](std::int16_t* to, const std::int16_t* from) {
    for (std::size_t i = 0; i < width; ++i) to[i] = std::min(to[i], static_cast<std::int16_t>(from[i] + 1));
  };
  for (int row = 1; row < space.rows; ++row) {
    std::int16_t* here = distance.data() + space.index(0, row);
    relax(here, here - width);
  }
  for (int row = space.rows - 2; row >= 0; --row) {
    std::int16_t* here = distance.data() + space.index(0, row);
    relax(here, here + width);
  }
  return distance;
}

}  // namespace

FreeSpace readFreeSpace(const gridmap::OccupancyRaster& map) {
  if (map.columns < 0 || map.rows < 0 || !(map.resolution_m > 0) ||
      map.occupancy.size() != static_cast<std::size_t>(map.columns) * static_cast<std::size_t>(map.rows))
    throw core::ContractError("readFreeSpace: the map's sizes, resolution and cells do not fit together");
  FreeSpace space;
  space.columns = map.columns + 2;
  space.rows = map.rows + 2;
  space.resolution_m = map.resolution_m;
  space.x_min_m = map.x_min_m - map.resolution_m;
  space.y_min_m = map.y_min_m - map.resolution_m;
  space.state.assign(static_cast<std::size_t>(space.columns) * space.rows, kUnknownCell);
  for (int row = 0; row < map.rows; ++row) {
    const float* from = map.occupancy.data() + static_cast<std::size_t>(row) * map.columns;
    std::uint8_t* to = space.state.data() + space.index(1, row + 1);
    unsigned unknown = 0;
    for (int i = 0; i < map.columns; ++i) {
      const auto is_free = static_cast<std::uint8_t>(from[i] < gridmap::kFreeBelow);
      const auto is_occupied = static_cast<std::uint8_t>(from[i] > gridmap::kOccupiedAbove);
      to[i] = static_cast<std::uint8_t>(2 * (1 - is_free) - is_occupied);
      unknown += to[i] >> 1;
    }
    space.known += static_cast<std::size_t>(map.columns) - unknown;
  }
  return space;
}

std::vector<std::int16_t> squaredClearance(const FreeSpace& space, std::uint8_t obstacles, int reach_cells) {
  if (reach_cells < 1 || reach_cells > 120)
    throw core::ContractError("squaredClearance: expected a reach of 1 to 120 cells");
  auto clearance = columnDistance(space, obstacles, reach_cells);
  const int width = space.columns;
  const auto cap = static_cast<std::int16_t>(reach_cells * reach_cells);
  // Beside the row, as far as the window looks, stands nothing.
  std::vector<std::int16_t> squares(static_cast<std::size_t>(width + 2 * reach_cells), cap);
  std::int16_t* const middle = squares.data() + reach_cells;
  for (int row = 0; row < space.rows; ++row) {
    std::int16_t* best = clearance.data() + space.index(0, row);
    const auto [low, high] = std::minmax_element(best, best + width);
    for (int i = 0; i < width; ++i) middle[i] = best[i] = static_cast<std::int16_t>(best[i] * best[i]);
    if (*low == *high && (*low == 0 || *low == cap)) continue;
    for (int aside = 1; aside < reach_cells; ++aside) {
      const auto more = static_cast<std::int16_t>(aside * aside);
      const std::int16_t *left = middle - aside, *right = middle + aside;
      for (int i = 0; i < width; ++i) {
        const std::int16_t nearer = std::min(left[i], right[i]);
        best[i] = std::min(best[i], static_cast<std::int16_t>(nearer + more));
      }
    }
  }
  return clearance;
}

CellBlock changedCells(const FreeSpace& a, const FreeSpace& b) {
  if (a.columns != b.columns || a.rows != b.rows)
    throw core::ContractError("changedCells: expected two maps of equal size");
  const auto width = static_cast<std::size_t>(a.columns);
  CellBlock block{a.columns, a.rows, 0, 0};
  for (int row = 0; row < a.rows; ++row) {
    const std::uint8_t *p = a.state.data() + a.index(0, row), *q = b.state.data() + a.index(0, row);
    if (std::memcmp(p, q, width) == 0) continue;
    block.first_row = std::min(block.first_row, row);
    block.last_row = row + 1;
    const auto first = std::mismatch(p, p + width, q).first - p;
    int last = a.columns;
    while (p[last - 1] == q[last - 1]) --last;
    block.first_column = std::min(block.first_column, static_cast<int>(first));
    block.last_column = std::max(block.last_column, last);
  }
  return block.last_row == 0 ? CellBlock{} : block;
}

CellBlock grown(const CellBlock& block, int cells, const FreeSpace& space) {
  return {std::max(block.first_column - cells, 0), std::max(block.first_row - cells, 0),
          std::min(block.last_column + cells, space.columns), std::min(block.last_row + cells, space.rows)};
}

FreeSpace cutOut(const FreeSpace& space, const CellBlock& block) {
  FreeSpace part;
  part.columns = block.columns();
  part.rows = block.last_row - block.first_row;
  part.resolution_m = space.resolution_m;
  part.x_min_m = space.x_min_m + block.first_column * space.resolution_m;
  part.y_min_m = space.y_min_m + block.first_row * space.resolution_m;
  part.state.resize(block.cells());
  for (int row = 0; row < part.rows; ++row)
    std::copy_n(space.state.data() + space.index(block.first_column, block.first_row + row), part.columns,
                part.state.data() + part.index(0, row));
  return part;
}

void paste(const FreeSpace& from, const CellBlock& block, FreeSpace& to) {
  for (int row = block.first_row; row < block.last_row; ++row)
    std::copy_n(from.state.data() + from.index(block.first_column, row), block.columns(),
                to.state.data() + to.index(block.first_column, row));
}

void closeGaps(FreeSpace& space) {
  const std::vector<std::uint8_t> before = space.state;
  const int width = space.columns;
  for (int row = 1; row + 1 < space.rows; ++row) {
    for (int column = 1; column + 1 < width; ++column) {
      const std::size_t i = space.index(column, row);
      if (before[i] != kUnknownCell) continue;
      const std::uint8_t* c = before.data() + i;
      const bool between = !(c[-1] | c[1]) || !(c[-width] | c[width]) || !(c[-width - 1] | c[width + 1]) ||
                           !(c[-width + 1] | c[width - 1]);
      if (!between) continue;
      const int around =
          c[-1] | c[1] | c[-width] | c[width] | c[-width - 1] | c[width + 1] | c[-width + 1] | c[width - 1];
      if (!(around & kOccupiedCell)) space.state[i] = kFreeCell;
    }
  }
}

}  // namespace slam::paths
