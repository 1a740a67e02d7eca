#include "libslam/world/clearance.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace slam::world {
namespace {

using Distance = std::uint16_t;  // cells; no plan is as high as kFar
constexpr Distance kFar = 65535;

/// How far up and down a disc's squares reach in the columns 0, 1, 2 ... beside its centre.
std::vector<Distance> columnsOfDisc(double radius) {
  const auto touches = [radius](int dx, int dy) {
    const double gap_x = std::max(0.0, dx - 0.5), gap_y = std::max(0.0, dy - 0.5);
    return gap_x * gap_x + gap_y * gap_y <= radius * radius;
  };
  std::vector<Distance> reach;
  int dy = static_cast<int>(std::min(radius + 1, 40000.0));
  for (int dx = 0; dx <= 40000 && touches(dx, 0); ++dx) {
    while (!touches(dx, dy)) --dy;
    reach.push_back(static_cast<Distance>(dy));
  }
  return reach;
}

/// Rows up or down to the nearest marked cell of the same column; kFar where there is none.
template <class IsMarked>
std::vector<Distance> rowsToMarked(int columns, size_t cells, IsMarked is_marked) {
  std::vector<Distance> distance(cells);
  const auto width = static_cast<size_t>(columns);
  for (size_t i = 0; i < cells; ++i) {
    const Distance below = i < width ? kFar : distance[i - width];
    distance[i] = is_marked(i) ? Distance{0} : static_cast<Distance>(below == kFar ? kFar : below + 1);
  }
  for (size_t i = cells; i-- > 0;) {
    const Distance above = i + width >= cells ? kFar : distance[i + width];
    if (above != kFar) distance[i] = std::min<Distance>(distance[i], static_cast<Distance>(above + 1));
  }
  return distance;
}

/// True where some column of the disc around a cell reaches a marked cell.
std::vector<char> touched(int columns, const std::vector<Distance>& rows_to_marked,
                          const std::vector<Distance>& reach) {
  std::vector<char> result(rows_to_marked.size(), 0);
  for (size_t begin = 0; begin < result.size(); begin += static_cast<size_t>(columns)) {
    const Distance* distance = rows_to_marked.data() + begin;
    char* row = result.data() + begin;
    for (int dx = 0; dx < std::min(static_cast<int>(reach.size()), columns); ++dx) {
      const Distance most = reach[static_cast<size_t>(dx)];
      for (int x = 0; x + dx < columns; ++x) row[x] |= static_cast<char>(distance[x + dx] <= most);
      for (int x = dx; x < columns; ++x) row[x] |= static_cast<char>(distance[x - dx] <= most);
    }
  }
  return result;
}

}  // namespace

std::vector<char> admissibleCells(const CellMap& map, double radius) {
  const auto is_wall = [&map](size_t i) { return map.cells[i] == Cell::kOccupied; };
  std::vector<char> cells =
      touched(map.columns, rowsToMarked(map.columns, map.cells.size(), is_wall), columnsOfDisc(radius));
  for (int row = 0; row < map.rows; ++row) {
    const bool row_fits = row + 0.5 - radius >= 0 && row + 0.5 + radius <= map.rows;
    for (int column = 0; column < map.columns; ++column) {
      const bool fits = row_fits && column + 0.5 - radius >= 0 && column + 0.5 + radius <= map.columns;
      const size_t i = static_cast<size_t>(row) * map.columns + column;
      cells[i] = fits && !cells[i] && map.cells[i] == Cell::kFree;
    }
  }
  return cells;
}

std::vector<char> cellsUnderDiscs(int columns, const std::vector<char>& marked, double radius) {
  const auto is_marked = [&marked](size_t i) { return marked[i] != 0; };
  return touched(columns, rowsToMarked(columns, marked.size(), is_marked), columnsOfDisc(radius));
}

}  // namespace slam::world
