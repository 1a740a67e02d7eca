#include "libslam/metrics/map_structure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "libslam/core/elementary.h"
#include "libslam/world/region.h"

namespace slam::metrics {
namespace {

using world::Cell;
using Mask = std::vector<char>;

/// Sets of 8-connected marked cells, each as ascending indices.
std::vector<std::vector<size_t>> groupsOf(int columns, int rows, const Mask& marked) {
  std::vector<std::vector<size_t>> groups;
  Mask open = marked;
  for (size_t seed = 0; seed < open.size(); ++seed) {
    if (!open[seed]) continue;
    open[seed] = 0;
    std::vector<size_t> group = {seed};
    for (size_t next = 0; next < group.size(); ++next) {
      const int column = static_cast<int>(group[next] % static_cast<size_t>(columns));
      const int row = static_cast<int>(group[next] / static_cast<size_t>(columns));
      for (int r = std::max(row - 1, 0); r <= std::min(row + 1, rows - 1); ++r)
        for (int c = std::max(column - 1, 0); c <= std::min(column + 1, columns - 1); ++c) {
          const size_t cell = static_cast<size_t>(r) * static_cast<size_t>(columns) + static_cast<size_t>(c);
          if (!open[cell]) continue;
          open[cell] = 0;
          group.push_back(cell);
        }
    }
    groups.push_back(std::move(group));
  }
  return groups;
}

bool isSpeck(const std::vector<size_t>& group, int columns, double resolution_m) {
  size_t first_column = group[0] % static_cast<size_t>(columns), last_column = first_column;
  for (const size_t cell : group) {
    first_column = std::min(first_column, cell % static_cast<size_t>(columns));
    last_column = std::max(last_column, cell % static_cast<size_t>(columns));
  }
  const auto [first, last] = std::minmax_element(group.begin(), group.end());
  const size_t rows = *last / static_cast<size_t>(columns) - *first / static_cast<size_t>(columns) + 1;
  const double widest_m = resolution_m * static_cast<double>(std::max(rows, last_column - first_column + 1));
  return widest_m <= kSpeck_m + 1e-9;
}

Mask wallsOf(const world::CellMap& map) {
  Mask walls(map.cells.size());
  std::transform(map.cells.begin(), map.cells.end(), walls.begin(),
                 [](Cell cell) { return static_cast<char>(cell == Cell::kOccupied); });
  for (const auto& group : groupsOf(map.columns, map.rows, walls))
    if (isSpeck(group, map.columns, map.resolution_m))
      for (const size_t cell : group) walls[cell] = 0;
  return walls;
}

/// Weights of a Gaussian up to three deviations, index 0 in the middle; their sum is 1 with both sides.
std::vector<double> gaussian(double deviation_cells) {
  std::vector<double> weights;
  double sum = 0;
  for (int i = 0; i <= static_cast<int>(std::ceil(3 * deviation_cells)); ++i) {
    weights.push_back(core::exp(-0.5 * i * i / (deviation_cells * deviation_cells)));
    sum += i == 0 ? weights.back() : 2 * weights.back();
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

/// A square piece of a picture; cells outside of it are read as 0.
struct Tile {
  int side;
  std::vector<double> values;
  explicit Tile(int cells) : side(cells), values(static_cast<size_t>(cells) * static_cast<size_t>(cells)) {}
  double& at(int column, int row) { return values[static_cast<size_t>(row) * side + column]; }
  double at(int column, int row) const { return values[static_cast<size_t>(row) * side + column]; }
};

/// The pair at +-i is added first, so that a mirrored picture gives mirrored bits.
void blur(Tile& tile, const std::vector<double>& weights) {
  const auto pass = [&](bool along_rows) {
    const Tile from = tile;
    const auto value = [&](int along, int across) {
      if (along < 0 || along >= from.side) return 0.0;
      return along_rows ? from.at(along, across) : from.at(across, along);
    };
    for (int across = 0; across < tile.side; ++across)
      for (int along = 0; along < tile.side; ++along) {
        double sum = weights[0] * value(along, across);
        for (int i = 1; i < static_cast<int>(weights.size()); ++i)
          sum += weights[static_cast<size_t>(i)] * (value(along - i, across) + value(along + i, across));
        (along_rows ? tile.at(along, across) : tile.at(across, along)) = sum;
      }
  };
  pass(true);
  pass(false);
}

constexpr int kInner = 64;  ///< cells of a tile that are answered; the rest is the reach of the filters

/// Marks the corner cells of one tile.
void markCorners(const world::CellMap& map, const Mask& walls, int column0, int row0, Mask& corners) {
  const auto blurring = gaussian(std::max(1.0, kCornerBlur_m / map.resolution_m));
  const auto window = gaussian(std::max(1.0, kCornerWindow_m / map.resolution_m));
  const int margin = static_cast<int>(blurring.size() + window.size());
  const int side = kInner + 2 * margin;
  Tile picture(side);
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      const int c = column0 - margin + column, r = row0 - margin + row;
      if (map.contains(c, r))
        picture.at(column, row) = walls[static_cast<size_t>(r) * static_cast<size_t>(map.columns) + c];
    }
  blur(picture, blurring);
  Tile xx(side), xy(side), yy(side);
  for (int row = 1; row + 1 < side; ++row)
    for (int column = 1; column + 1 < side; ++column) {
      const double dx = picture.at(column + 1, row) - picture.at(column - 1, row);
      const double dy = picture.at(column, row + 1) - picture.at(column, row - 1);
      xx.at(column, row) = dx * dx;
      xy.at(column, row) = dx * dy;
      yy.at(column, row) = dy * dy;
    }
  for (Tile* tile : {&xx, &xy, &yy}) blur(*tile, window);
  for (int row = 0; row < kInner; ++row)
    for (int column = 0; column < kInner; ++column) {
      const int c = column0 + column, r = row0 + row;
      if (!map.contains(c, r)) continue;
      const size_t cell = static_cast<size_t>(r) * static_cast<size_t>(map.columns) + static_cast<size_t>(c);
      if (!walls[cell]) continue;
      const int i = column + margin, j = row + margin;
      const double determinant = xx.at(i, j) * yy.at(i, j) - xy.at(i, j) * xy.at(i, j);
      const double trace = xx.at(i, j) + yy.at(i, j);
      corners[cell] = static_cast<char>(4 * determinant > kCornerRoundness * trace * trace);
    }
}

size_t countCorners(const world::CellMap& map) {
  const Mask walls = wallsOf(map);
  Mask corners(walls.size(), 0);
  for (int row0 = 0; row0 < map.rows; row0 += kInner)
    for (int column0 = 0; column0 < map.columns; column0 += kInner) {
      bool has_wall = false;
      for (int row = row0; row < std::min(row0 + kInner, map.rows) && !has_wall; ++row) {
        const auto begin = walls.begin() + static_cast<std::ptrdiff_t>(row) * map.columns + column0;
        const auto end = begin + std::min(kInner, map.columns - column0);
        has_wall = std::find(begin, end, 1) != end;
      }
      if (has_wall) markCorners(map, walls, column0, row0, corners);
    }
  return groupsOf(map.columns, map.rows, corners).size();
}

size_t countEnclosedAreas(const world::CellMap& map) {
  Mask free(map.cells.size());
  std::transform(map.cells.begin(), map.cells.end(), free.begin(),
                 [](Cell cell) { return static_cast<char>(cell == Cell::kFree); });
  std::map<size_t, size_t> cells_of;  // region -> cells
  for (const auto& run : world::regionRuns(map.columns, free)) cells_of[run.region] += run.end - run.begin;
  const double cell_m2 = map.resolution_m * map.resolution_m;
  const auto areas = std::count_if(cells_of.begin(), cells_of.end(), [&](const auto& region) {
    return static_cast<double>(region.second) * cell_m2 >= kSmallestArea_m2 - 1e-9;
  });
  return areas == 0 ? 0 : static_cast<size_t>(areas) - 1;
}

}  // namespace

MapStructure mapStructure(const world::CellMap& map) {
  const auto occupied = std::count(map.cells.begin(), map.cells.end(), Cell::kOccupied);
  const auto free = std::count(map.cells.begin(), map.cells.end(), Cell::kFree);
  MapStructure structure{std::numeric_limits<double>::quiet_NaN(), 0, 0};
  if (occupied + free == 0) return structure;
  structure.occupied_share = static_cast<double>(occupied) / static_cast<double>(occupied + free);
  structure.corners = countCorners(map);
  structure.enclosed_areas = countEnclosedAreas(map);
  return structure;
}

}  // namespace slam::metrics
