#include "libslam/paths/frontier.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace slam::paths {
namespace {

/// Those in some rows, added.
void addFrontierCells(const FreeSpace& space, int first_row, int last_row, std::vector<std::size_t>& cells) {
  const int width = space.columns;
  // Whole words, with room for the last one.
  using Word = std::uint64_t;
  std::vector<std::uint8_t> hit(static_cast<std::size_t>(width) + sizeof(Word), 0);
  std::uint8_t* const hits = hit.data();
  for (int row = std::max(first_row, 1); row < std::min(last_row, space.rows - 1); ++row) {
    const std::uint8_t* const here = space.state.data() + space.index(0, row);
    unsigned any = 0;
    // Without a branch, so that it vectorises: most rows of a map hold few frontier cells or none.
    for (int i = 1; i + 1 < width; ++i) {
      const auto around =
          static_cast<std::uint8_t>(here[i - 1] | here[i + 1] | here[i - width] | here[i + width]);
      hits[i] = static_cast<std::uint8_t>((here[i] == kFreeCell) & ((around & kUnknownCell) != 0));
      any |= hits[i];
    }
    if (!any) continue;
    for (int first = 0; first < width; first += static_cast<int>(sizeof(Word))) {
      Word word;
      std::memcpy(&word, hits + first, sizeof word);
      if (word == 0) continue;
      for (int i = first; i < first + static_cast<int>(sizeof word); ++i)
        if (hits[i]) cells.push_back(space.index(i, row));
    }
  }
}

auto lowerBound(const std::vector<std::size_t>& cells, std::size_t cell) {
  return std::lower_bound(cells.begin(), cells.end(), cell);
}

}  // namespace

std::vector<std::size_t> frontierCells(const FreeSpace& space) {
  std::vector<std::size_t> cells;
  addFrontierCells(space, 0, space.rows, cells);
  return cells;
}

void FrontierCells::update(const FreeSpace& space, const CellBlock& changed) {
  const bool is_new = columns_ != space.columns || rows_ != space.rows;
  columns_ = space.columns, rows_ = space.rows;
  if (!is_new && changed.isEmpty()) return;
  const CellBlock near = is_new ? CellBlock{0, 0, columns_, rows_} : grown(changed, 1, space);
  const auto first = is_new ? cells_.cbegin() : lowerBound(cells_, space.index(0, near.first_row));
  const auto last = is_new ? cells_.cend() : lowerBound(cells_, space.index(0, near.last_row));
  std::vector<std::size_t> cells(cells_.cbegin(), first);
  addFrontierCells(space, near.first_row, near.last_row, cells);
  cells.insert(cells.end(), last, cells_.cend());
  cells_ = std::move(cells);
}

std::vector<std::size_t> frontierCellsAmong(const FreeSpace& space, const std::vector<std::size_t>& cells) {
  std::vector<std::size_t> left;
  left.reserve(cells.size());
  for (const std::size_t cell : cells)
    if (isFrontierCell(space, cell)) left.push_back(cell);
  return left;
}

bool isFrontierCell(const FreeSpace& space, std::size_t cell) {
  const auto width = static_cast<std::size_t>(space.columns);
  const std::uint8_t* const here = space.state.data() + cell;
  return *here == kFreeCell && ((here[-1] | here[1] | *(here - width) | here[width]) & kUnknownCell) != 0;
}

std::vector<Frontier> findFrontiers(const FreeSpace& space, std::size_t min_cells) {
  return findFrontiers(space, frontierCells(space), min_cells);
}

std::vector<Frontier> findFrontiers(const FreeSpace& space, const std::vector<std::size_t>& cells,
                                    std::size_t min_cells) {
  const auto width = static_cast<std::size_t>(space.columns);
  // Each cell points at an earlier one beside it, the first of its frontier at itself. A raster of marks
  // would cost more than all the rest.
  std::vector<std::size_t> before(cells.size());
  const auto firstOf = [&](std::size_t i) {
    while (before[i] != i) i = before[i] = before[before[i]];
    return i;
  };
  const auto join = [&](std::size_t i, std::size_t j) {
    const std::size_t a = firstOf(i), b = firstOf(j);
    before[std::max(a, b)] = std::min(a, b);
  };
  std::size_t above = 0;  // the first that may touch the one at hand from the row before
  for (std::size_t i = 0; i < cells.size(); ++i) {
    before[i] = i;
    if (i > 0 && cells[i - 1] + 1 == cells[i]) join(i, i - 1);
    while (cells[above] + width + 1 < cells[i]) ++above;
    for (std::size_t j = above; j < i && cells[j] + width <= cells[i] + 1; ++j) join(i, j);
  }
  std::vector<std::size_t> size(cells.size(), 0), place(cells.size(), 0);
  for (std::size_t i = 0; i < cells.size(); ++i) ++size[firstOf(i)];
  std::vector<Frontier> frontiers;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::size_t first = firstOf(i);
    if (size[first] < min_cells) continue;
    if (first == i) {
      place[i] = frontiers.size();
      frontiers.emplace_back().cells.reserve(size[i]);
    }
    frontiers[place[first]].cells.push_back(cells[i]);
  }
  return frontiers;
}

}  // namespace slam::paths
