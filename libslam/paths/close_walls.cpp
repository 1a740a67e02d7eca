#include "libslam/paths/close_walls.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "libslam/paths/frontier.h"

namespace slam::paths {
namespace {

struct Axis {
  int dc, dr;
  double length;
};
constexpr double kRoot2 = 1.4142135623730951, kRoot5 = 2.23606797749979;
constexpr std::array<Axis, 8> kAxes = {{{1, 0, 1},
                                        {0, 1, 1},
                                        {1, 1, kRoot2},
                                        {1, -1, kRoot2},
                                        {2, 1, kRoot5},
                                        {1, 2, kRoot5},
                                        {2, -1, kRoot5},
                                        {1, -2, kRoot5}}};

/// Steps of d cells along a line of so many that stay on it.
int stepsInside(int at, int d, int cells) {
  if (d == 0) return std::numeric_limits<int>::max();
  return d > 0 ? (cells - 1 - at) / d : at / -d;
}

/// Cells along the axis to the first occupied one, through unknown ones; infinity when none is within
/// most_cells.
double toWall(const FreeSpace& space, int column, int row, const Axis& axis, int sign, double most_cells) {
  const int dc = sign * axis.dc, dr = sign * axis.dr;
  const int steps = std::min({static_cast<int>(std::min(most_cells / axis.length, 1e6)),
                              stepsInside(column, dc, space.columns), stepsInside(row, dr, space.rows)});
  const std::ptrdiff_t step = std::ptrdiff_t{dr} * space.columns + dc;
  const std::uint8_t* state = space.state.data() + space.index(column, row);
  for (int i = 1; i <= steps; ++i) {
    state += step;
    if (*state == kOccupiedCell) return i * axis.length;
    if (*state == kFreeCell) break;
  }
  return std::numeric_limits<double>::infinity();
}

/// Of an unknown cell that is asked already: a bit besides CellState's. Ways to walls lead through it as
/// well.
constexpr std::uint8_t kAsked = 4;

/// The unknown cells that touch one of `cells`, corners too, each once; they are marked.
std::vector<std::size_t> markUnknownBeside(FreeSpace& space, const std::vector<std::size_t>& cells) {
  const auto width = static_cast<std::size_t>(space.columns);
  std::vector<std::size_t> unknown;
  for (const std::size_t cell : cells)
    for (const std::size_t row : {cell - width, cell, cell + width})
      for (const std::size_t beside : {row - 1, row, row + 1}) {
        if (space.state[beside] != kUnknownCell) continue;
        space.state[beside] |= kAsked;
        unknown.push_back(beside);
      }
  return unknown;
}

}  // namespace

void closeWalls(FreeSpace& space, double gap_m) {
  closeWalls(space, frontierCells(space), gap_m);
}

std::vector<std::size_t> closeWalls(FreeSpace& space, const std::vector<std::size_t>& frontier_cells,
                                    double gap_m) {
  const double most = gap_m / space.resolution_m + 1e-9;
  const auto width = static_cast<std::size_t>(space.columns);
  const auto isBetweenWalls = [&](std::size_t cell) {
    const int column = static_cast<int>(cell % width), row = static_cast<int>(cell / width);
    return std::any_of(kAxes.begin(), kAxes.end(), [&](const Axis& axis) {
      const double ahead = toWall(space, column, row, axis, 1, most);
      return ahead <= most && ahead + toWall(space, column, row, axis, -1, most) <= most;
    });
  };
  const auto unknown = markUnknownBeside(space, frontier_cells);
  std::vector<std::uint8_t> becomes;
  becomes.reserve(unknown.size());
  for (const std::size_t cell : unknown)
    becomes.push_back(isBetweenWalls(cell) ? kOccupiedCell : kUnknownCell);
  std::vector<std::size_t> closed;
  // Only then, so that no cell is closed because of another one that was.
  for (std::size_t i = 0; i < unknown.size(); ++i) {
    space.state[unknown[i]] = becomes[i];
    if (becomes[i] == kOccupiedCell) closed.push_back(unknown[i]);
  }
  return closed;
}

}  // namespace slam::paths
