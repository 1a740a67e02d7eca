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

/// Of two rows, as a block of one.
CellBlock differences(const std::uint8_t* a, const std::uint8_t* b, int columns) {
  if (columns == 0 || std::memcmp(a, b, static_cast<std::size_t>(columns)) == 0) return {};
  const auto first = static_cast<int>(std::mismatch(a, a + columns, b).first - a);
  int last = columns;
  while (a[last - 1] == b[last - 1]) --last;
  return {first, 0, last, 1};
}

/// States of a row's cells; answers how many are unknown. In pieces, and in words as wide as a cell of the
/// map before the narrow ones, so that it vectorises.
std::size_t readRow(const float* from, int columns, std::uint8_t* states) {
  constexpr int kPiece = 256;
  std::int32_t wide[kPiece];
  std::size_t unknown = 0;
  for (int first = 0; first < columns; first += kPiece) {
    const int count = std::min(kPiece, columns - first);
    std::int32_t unknown_here = 0;
    for (int i = 0; i < count; ++i) {
      const std::int32_t is_free = from[first + i] < gridmap::kFreeBelow ? 1 : 0;
      const std::int32_t is_occupied = from[first + i] > gridmap::kOccupiedAbove ? 1 : 0;
      wide[i] = 2 * (1 - is_free) - is_occupied;
      unknown_here += wide[i] >> 1;
    }
    for (int i = 0; i < count; ++i) states[first + i] = static_cast<std::uint8_t>(wide[i]);
    unknown += static_cast<std::size_t>(unknown_here);
  }
  return unknown;
}

}  // namespace

FreeSpace readFreeSpace(const gridmap::OccupancyRaster& map) {
  FreeSpace space;
  updateFreeSpace(map, space);
  return space;
}

CellBlock updateFreeSpace(const gridmap::OccupancyRaster& map, FreeSpace& space) {
  if (map.columns < 0 || map.rows < 0 || !(map.resolution_m > 0) ||
      map.occupancy.size() != static_cast<std::size_t>(map.columns) * static_cast<std::size_t>(map.rows))
    throw core::ContractError("readFreeSpace: the map's sizes, resolution and cells do not fit together");
  const bool is_new = space.columns != map.columns + 2 || space.rows != map.rows + 2;
  if (is_new) {
    space.columns = map.columns + 2;
    space.rows = map.rows + 2;
    space.state.assign(static_cast<std::size_t>(space.columns) * space.rows, kUnknownCell);
  }
  space.resolution_m = map.resolution_m;
  space.x_min_m = map.x_min_m - map.resolution_m;
  space.y_min_m = map.y_min_m - map.resolution_m;
  space.known = 0;
  CellBlock changed;
  // A row that stays the same is not written, which is most of them.
  std::vector<std::uint8_t> newest(static_cast<std::size_t>(map.columns));
  for (int row = 0; row < map.rows; ++row) {
    const float* from = map.occupancy.data() + static_cast<std::size_t>(row) * map.columns;
    std::uint8_t* const states = newest.data();
    const std::size_t unknown = readRow(from, map.columns, states);
    space.known += static_cast<std::size_t>(map.columns) - unknown;
    std::uint8_t* const to = space.state.data() + space.index(1, row + 1);
    const CellBlock in_row = differences(to, states, map.columns);
    if (in_row.isEmpty()) continue;
    std::copy_n(states, map.columns, to);
    changed = joined(changed, {in_row.first_column + 1, row + 1, in_row.last_column + 1, row + 2});
  }
  return is_new ? CellBlock{0, 0, space.columns, space.rows} : changed;
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
  CellBlock block;
  for (int row = 0; row < a.rows; ++row) {
    const CellBlock in_row =
        differences(a.state.data() + a.index(0, row), b.state.data() + b.index(0, row), a.columns);
    if (!in_row.isEmpty()) block = joined(block, {in_row.first_column, row, in_row.last_column, row + 1});
  }
  return block;
}

CellBlock joined(const CellBlock& a, const CellBlock& b) {
  if (a.isEmpty()) return b;
  if (b.isEmpty()) return a;
  return {std::min(a.first_column, b.first_column), std::min(a.first_row, b.first_row),
          std::max(a.last_column, b.last_column), std::max(a.last_row, b.last_row)};
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
