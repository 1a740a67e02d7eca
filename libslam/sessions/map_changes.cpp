#include "libslam/sessions/map_changes.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

namespace slam::sessions {
namespace {

using core::Point2;
using world::Cell;
using world::CellMap;

struct Spot {
  int column, row;
};

std::optional<Spot> spotOf(const CellMap& map, const Point2& p) {
  const Point2 cell = world::pointToCells(map, p);
  const Spot spot{static_cast<int>(std::floor(cell.x)), static_cast<int>(std::floor(cell.y))};
  if (!map.contains(spot.column, spot.row)) return std::nullopt;
  return spot;
}

Point2 centreOf(const CellMap& map, const Spot& spot) {
  return world::cellsToPoint(map, {spot.column + 0.5, spot.row + 0.5});
}

/// Whether a map is free at a point, and has no wall near it.
bool isFreeAround(const CellMap& map, const Point2& p) {
  const auto spot = spotOf(map, p);
  if (!spot || map.at(spot->column, spot->row) != Cell::kFree) return false;
  const int reach = static_cast<int>(std::ceil(kTolerance_m / map.resolution_m));
  for (int row = spot->row - reach; row <= spot->row + reach; ++row)
    for (int column = spot->column - reach; column <= spot->column + reach; ++column) {
      const bool is_wall = map.contains(column, row) && map.at(column, row) == Cell::kOccupied;
      if (is_wall && core::distance(centreOf(map, {column, row}), p) <= kTolerance_m) return false;
    }
  return true;
}

/// The occupied cells of a map where another is free, gathered into pieces.
std::vector<MapChange> onlyIn(const CellMap& map, const CellMap& other, MapChange::Kind kind) {
  std::vector<char> open(map.cells.size(), 0);
  const auto index = [&](int column, int row) { return static_cast<size_t>(row) * map.columns + column; };
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column)
      if (map.at(column, row) == Cell::kOccupied)
        open[index(column, row)] = isFreeAround(other, centreOf(map, {column, row}));
  const int gap = static_cast<int>(std::ceil(kGap_m / map.resolution_m));
  std::vector<MapChange> pieces;
  std::vector<Spot> todo;
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column) {
      if (!open[index(column, row)]) continue;
      MapChange piece{kind, {1e300, 1e300}, {-1e300, -1e300}, 0};
      todo.push_back({column, row});
      open[index(column, row)] = 0;
      while (!todo.empty()) {
        const Spot spot = todo.back();
        todo.pop_back();
        const Point2 p = centreOf(map, spot);
        const double half_m = 0.5 * map.resolution_m;
        piece.least = {std::min(piece.least.x, p.x - half_m), std::min(piece.least.y, p.y - half_m)};
        piece.most = {std::max(piece.most.x, p.x + half_m), std::max(piece.most.y, p.y + half_m)};
        piece.area_m2 += map.resolution_m * map.resolution_m;
        for (int r = spot.row - gap; r <= spot.row + gap; ++r)
          for (int c = spot.column - gap; c <= spot.column + gap; ++c)
            if (map.contains(c, r) && open[index(c, r)]) open[index(c, r)] = 0, todo.push_back({c, r});
      }
      if (core::distance(piece.least, piece.most) >= kLeast_m) pieces.push_back(piece);
    }
  return pieces;
}

double comparedArea(const CellMap& before, const CellMap& after) {
  double cells = 0;
  for (int row = 0; row < before.rows; ++row)
    for (int column = 0; column < before.columns; ++column) {
      if (before.at(column, row) == Cell::kUnknown) continue;
      const auto spot = spotOf(after, centreOf(before, {column, row}));
      cells += spot && after.at(spot->column, spot->row) != Cell::kUnknown;
    }
  return cells * before.resolution_m * before.resolution_m;
}

}  // namespace

MapChanges findChanges(const CellMap& before, const CellMap& after) {
  MapChanges found;
  found.changes = onlyIn(after, before, MapChange::Kind::kNew);
  const auto gone = onlyIn(before, after, MapChange::Kind::kGone);
  found.changes.insert(found.changes.end(), gone.begin(), gone.end());
  const auto rank = [](const MapChange& change) {
    // To the millimetre, so that rounding decides nothing.
    return std::tuple(-std::lround(1000 * core::distance(change.least, change.most)), change.kind,
                      change.least.x, change.least.y);
  };
  std::sort(found.changes.begin(), found.changes.end(),
            [&](const MapChange& a, const MapChange& b) { return rank(a) < rank(b); });
  found.compared_m2 = comparedArea(before, after);
  return found;
}

}  // namespace slam::sessions
