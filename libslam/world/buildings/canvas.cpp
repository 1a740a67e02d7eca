#include "libslam/world/buildings/canvas.h"

#include <algorithm>

#include "libslam/world/region.h"

namespace slam::world {
namespace {

constexpr int kTries = 25;

Rect atWall(const Rect& room, Side wall, int along, int length, int depth) {
  switch (wall) {
    case Side::kWest:
      return {room.x0, room.y0 + along, room.x0 + depth, room.y0 + along + length};
    case Side::kEast:
      return {room.x1 - depth, room.y0 + along, room.x1, room.y0 + along + length};
    case Side::kSouth:
      return {room.x0 + along, room.y0, room.x0 + along + length, room.y0 + depth};
    default:
      return {room.x0 + along, room.y1 - depth, room.x0 + along + length, room.y1};
  }
}

}  // namespace

Canvas::Canvas(int width, int height) {
  plan_.columns = width + 2 * kRim;
  plan_.rows = height + 2 * kRim;
  plan_.cells.assign(static_cast<size_t>(plan_.columns) * plan_.rows, Cell::kUnknown);
}

void Canvas::carve(const Rect& rect) {
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x) at(x, y) = Cell::kFree;
}

void Canvas::fill(const Rect& rect) {
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x) at(x, y) = Cell::kOccupied;
}

void Canvas::fillDisc(const Rect& bounds) {
  const int diameter = std::min(bounds.width(), bounds.height());
  for (int y = 0; y < diameter; ++y)
    for (int x = 0; x < diameter; ++x) {
      const int dx = 2 * x + 1 - diameter, dy = 2 * y + 1 - diameter;  // doubled, so that centres are whole
      if (dx * dx + dy * dy <= diameter * diameter) at(bounds.x0 + x, bounds.y0 + y) = Cell::kOccupied;
    }
}

void Canvas::raiseWalls(int thickness) {
  const Plan carved = plan_;
  for (int row = 0; row < carved.rows; ++row)
    for (int column = 0; column < carved.columns; ++column) {
      if (carved.at(column, row) != Cell::kFree) continue;
      for (int y = row - thickness; y <= row + thickness; ++y)
        for (int x = column - thickness; x <= column + thickness; ++x)
          if (carved.contains(x, y) && carved.at(x, y) != Cell::kFree)
            at(x - kRim, y - kRim) = Cell::kOccupied;
    }
}

void Canvas::recess(const Rect& room, Side wall, int along, int length, int depth) {
  for (int i = 0; i < length; ++i) {
    const Rect inside = atWall(room, wall, along + i, 1, 1);
    if (!isFree(inside.x0, inside.y0)) continue;
    Rect hollow = inside;
    if (wall == Side::kWest) hollow.x0 -= depth;
    if (wall == Side::kEast) hollow.x1 += depth;
    if (wall == Side::kSouth) hollow.y0 -= depth;
    if (wall == Side::kNorth) hollow.y1 += depth;
    carve(hollow);
  }
}

bool Canvas::allFree(const Rect& rect) const {
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x)
      if (!isFree(x, y)) return false;
  return true;
}

bool Canvas::noneFree(const Rect& rect) const {
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x)
      if (isFree(x, y)) return false;
  return true;
}

bool Canvas::leavesWaysOpen(const Rect& piece) const {
  if (!allFree(piece)) return false;
  const bool west = noneFree({piece.x0 - 1, piece.y0, piece.x0, piece.y1});
  const bool east = noneFree({piece.x1, piece.y0, piece.x1 + 1, piece.y1});
  const bool south = noneFree({piece.x0, piece.y0 - 1, piece.x1, piece.y0});
  const bool north = noneFree({piece.x0, piece.y1, piece.x1, piece.y1 + 1});
  if ((west && east) || (south && north)) return false;
  const Rect with_passage{piece.x0 - (west ? 0 : kPassage), piece.y0 - (south ? 0 : kPassage),
                          piece.x1 + (east ? 0 : kPassage), piece.y1 + (north ? 0 : kPassage)};
  return allFree(with_passage);
}

bool Canvas::place(const Rect& piece, Shape shape, Side back) {
  if (!leavesWaysOpen(piece)) return false;
  draw(piece, shape, back);
  return true;
}

void Canvas::draw(const Rect& piece, Shape shape, Side back) {
  const auto [x0, y0, x1, y1] = piece;
  switch (shape) {
    case Shape::kSolid:
      fill(piece);
      return;
    case Shape::kDisc:
      fillDisc(piece);
      return;
    case Shape::kLegs:
      for (const int x : {x0, x1 - 2})
        for (const int y : {y0, y1 - 2}) fill({x, y, x + 2, y + 2});
      return;
    case Shape::kDesk:
      break;
  }
  // The chair stands so close between drawers and panel that no robot fits in beside or behind it.
  constexpr int kDrawers = 8, kPanel = 2, kChair = 8;
  if (back == Side::kSouth || back == Side::kNorth) {
    fill({x0, y0, x0 + kDrawers, y1});
    fill({x1 - kPanel, y0, x1, y1});
    const int x = (x0 + kDrawers + x1 - kPanel - kChair) / 2;
    const int y = back == Side::kSouth ? y1 - kChair - 1 : y0 + 1;
    fillDisc({x, y, x + kChair, y + kChair});
  } else {
    fill({x0, y0, x1, y0 + kDrawers});
    fill({x0, y1 - kPanel, x1, y1});
    const int x = back == Side::kWest ? x1 - kChair - 1 : x0 + 1;
    const int y = (y0 + kDrawers + y1 - kPanel - kChair) / 2;
    fillDisc({x, y, x + kChair, y + kChair});
  }
}

bool Canvas::placeAt(const Rect& room, Side wall, int along, int length, int depth, Shape shape) {
  return place(atWall(room, wall, along, length, depth), shape, wall);
}

bool Canvas::placeAlong(core::RandomStream& random, const Rect& room, Side wall, int length, int depth,
                        Shape shape) {
  const bool runs_in_x = wall == Side::kSouth || wall == Side::kNorth;
  const int spare = (runs_in_x ? room.width() : room.height()) - length;
  for (int i = 0; i < kTries && spare >= 0; ++i)
    if (placeAt(room, wall, pick(random, 0, spare), length, depth, shape)) return true;
  return false;
}

bool Canvas::placeInside(core::RandomStream& random, const Rect& room, int width, int height, Shape shape) {
  for (int i = 0; i < kTries && room.width() >= width && room.height() >= height; ++i) {
    const int x = pick(random, room.x0, room.x1 - width), y = pick(random, room.y0, room.y1 - height);
    if (place({x, y, x + width, y + height}, shape)) return true;
  }
  return false;
}

Plan Canvas::plan(const std::string& name) const {
  Plan plan = plan_;
  plan.name = name;
  std::vector<char> is_free(plan.cells.size());
  for (size_t i = 0; i < plan.cells.size(); ++i) is_free[i] = plan.cells[i] == Cell::kFree;
  const std::vector<size_t> reachable = largestRegion(plan.columns, is_free);
  for (Cell& cell : plan.cells)
    if (cell == Cell::kFree) cell = Cell::kOccupied;
  for (const size_t index : reachable) plan.cells[index] = Cell::kFree;
  return plan;
}

int pick(core::RandomStream& random, int low, int high) {
  return low + static_cast<int>(random.below(static_cast<std::uint64_t>(high) - low + 1));
}

Side pickSide(core::RandomStream& random) {
  return static_cast<Side>(pick(random, 0, 3));
}

std::vector<std::pair<int, int>> partition(core::RandomStream& random, int total, int least, int most,
                                           int wall) {
  std::vector<std::pair<int, int>> rooms;
  for (int begin = 0;;) {
    const int rest = total - begin;
    const bool too_small_to_cut = rest < 2 * least + wall;
    if (rest <= most || too_small_to_cut) {
      rooms.emplace_back(begin, total);
      return rooms;
    }
    const int length = pick(random, least, std::min(most, rest - wall - least));
    rooms.emplace_back(begin, begin + length);
    begin += length + wall;
  }
}

}  // namespace slam::world
