#include "libslam/paths/close_walls.h"

#include <array>
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

/// Cells along the axis to the first occupied one, through unknown ones; infinity when none is within
/// most_cells.
double toWall(const FreeSpace& space, int column, int row, const Axis& axis, int sign, double most_cells) {
  for (double at = axis.length; at <= most_cells; at += axis.length) {
    column += sign * axis.dc, row += sign * axis.dr;
    if (!space.contains(column, row)) break;
    const std::uint8_t state = space.state[space.index(column, row)];
    if (state == kOccupiedCell) return at;
    if (state == kFreeCell) break;
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

void closeWalls(FreeSpace& space, double gap_m) {
  const double most = gap_m / space.resolution_m + 1e-9;
  const auto width = static_cast<std::size_t>(space.columns);
  std::vector<std::size_t> closed;
  const auto look = [&](int column, int row) {
    if (space.state[space.index(column, row)] != kUnknownCell) return;
    for (const Axis& axis : kAxes)
      if (toWall(space, column, row, axis, 1, most) + toWall(space, column, row, axis, -1, most) <= most)
        return closed.push_back(space.index(column, row));
  };
  for (const auto& frontier : findFrontiers(space, 1))
    for (const std::size_t cell : frontier.cells)
      for (int dr = -1; dr <= 1; ++dr)
        for (int dc = -1; dc <= 1; ++dc)
          look(static_cast<int>(cell % width) + dc, static_cast<int>(cell / width) + dr);
  // Only then, so that no cell is closed because of another one that was.
  for (const std::size_t cell : closed) space.state[cell] = kOccupiedCell;
}

}  // namespace slam::paths
