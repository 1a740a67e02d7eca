#include "libslam/buildings/drawn/canvas.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "libslam/world/region.h"

namespace slam::buildings {
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

int CanvasScale::cells(int length_cm) const {
  const std::int64_t cell_um = std::llround(resolution_m * 1e6), length_um = std::int64_t{10000} * length_cm;
  return static_cast<int>(std::max<std::int64_t>(1, (length_um + cell_um / 2) / cell_um));
}

Canvas::Canvas(int width, int height, const CanvasScale& scale) : scale_(scale) {
  plan_.columns = width + 2 * scale.rim;
  plan_.rows = height + 2 * scale.rim;
  plan_.resolution_m = scale.resolution_m;
  plan_.cells.assign(static_cast<size_t>(plan_.columns) * plan_.rows, world::Cell::kUnknown);
}

void Canvas::carve(const Rect& rect) {
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x) at(x, y) = world::Cell::kFree;
}

void Canvas::carveDoor(const Rect& rect) {
  carve(rect);
  plan_.doors.push_back(
      {rect.x0 + scale_.rim, rect.y0 + scale_.rim, rect.x1 + scale_.rim, rect.y1 + scale_.rim});
}

void Canvas::fill(const Rect& rect) {
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x) at(x, y) = world::Cell::kOccupied;
}

void Canvas::fillDisc(const Rect& bounds) {
  const int diameter = std::min(bounds.width(), bounds.height());
  for (int y = 0; y < diameter; ++y)
    for (int x = 0; x < diameter; ++x) {
      const int dx = 2 * x + 1 - diameter, dy = 2 * y + 1 - diameter;  // doubled, so that centres are whole
      if (dx * dx + dy * dy <= diameter * diameter) at(bounds.x0 + x, bounds.y0 + y) = world::Cell::kOccupied;
    }
}

void Canvas::raiseWalls(int thickness) {
  // A square reaches as far in x as in y, so first the rows are widened and then the columns.
  const int columns = plan_.columns, rows = plan_.rows;
  std::vector<char> near_in_row(plan_.cells.size(), 0);
  for (int row = 0; row < rows; ++row) {
    const size_t begin = static_cast<size_t>(row) * columns;
    int next = 0;  // marked up to here
    for (int column = 0; column < columns; ++column) {
      if (plan_.cells[begin + column] != world::Cell::kFree) continue;
      for (next = std::max(next, column - thickness); next < std::min(columns, column + thickness + 1);
           ++next)
        near_in_row[begin + next] = 1;
    }
  }
  std::vector<char> near(static_cast<size_t>(columns));
  for (int row = 0; row < rows; ++row) {
    std::fill(near.begin(), near.end(), 0);
    for (int y = std::max(0, row - thickness); y <= std::min(rows - 1, row + thickness); ++y) {
      const char* other = near_in_row.data() + static_cast<size_t>(y) * columns;
      for (int column = 0; column < columns; ++column) near[column] |= other[column];
    }
    world::Cell* cells = plan_.cells.data() + static_cast<size_t>(row) * columns;
    for (int column = 0; column < columns; ++column)
      if (near[column] && cells[column] != world::Cell::kFree) cells[column] = world::Cell::kOccupied;
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
  for (const Rect& place : kept_free_)
    if (place.overlaps(piece)) return false;
  const bool west = noneFree({piece.x0 - 1, piece.y0, piece.x0, piece.y1});
  const bool east = noneFree({piece.x1, piece.y0, piece.x1 + 1, piece.y1});
  const bool south = noneFree({piece.x0, piece.y0 - 1, piece.x1, piece.y0});
  const bool north = noneFree({piece.x0, piece.y1, piece.x1, piece.y1 + 1});
  if ((west && east) || (south && north)) return false;
  const int passage = scale_.passage;
  const Rect with_passage{piece.x0 - (west ? 0 : passage), piece.y0 - (south ? 0 : passage),
                          piece.x1 + (east ? 0 : passage), piece.y1 + (north ? 0 : passage)};
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
    case Shape::kLegs: {
      const int leg = scale_.cells(10);
      for (const int x : {x0, x1 - leg})
        for (const int y : {y0, y1 - leg}) fill({x, y, x + leg, y + leg});
      return;
    }
    case Shape::kDesk:
      break;
  }
  // The chair stands so close between drawers and panel that no robot fits in beside or behind it.
  const int drawers = scale_.cells(40), panel = scale_.cells(10), chair = scale_.cells(40);
  if (back == Side::kSouth || back == Side::kNorth) {
    fill({x0, y0, x0 + drawers, y1});
    fill({x1 - panel, y0, x1, y1});
    const int x = (x0 + drawers + x1 - panel - chair) / 2;
    const int y = back == Side::kSouth ? y1 - chair - 1 : y0 + 1;
    fillDisc({x, y, x + chair, y + chair});
  } else {
    fill({x0, y0, x1, y0 + drawers});
    fill({x0, y1 - panel, x1, y1});
    const int x = back == Side::kWest ? x1 - chair - 1 : x0 + 1;
    const int y = (y0 + drawers + y1 - panel - chair) / 2;
    fillDisc({x, y, x + chair, y + chair});
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

std::vector<Rect> Canvas::doors() const {
  std::vector<Rect> doors;
  for (const world::Door& d : plan_.doors)
    doors.push_back({d.x0 - scale_.rim, d.y0 - scale_.rim, d.x1 - scale_.rim, d.y1 - scale_.rim});
  return doors;
}

void Canvas::makeOf(world::Material material, const Rect& rect) {
  if (plan_.materials.empty()) plan_.materials.assign(plan_.cells.size(), world::Material::kPlain);
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x)
      if (at(x, y) == world::Cell::kOccupied) plan_.materials[index(x, y)] = material;
}

world::Plan Canvas::plan(const std::string& name) const {
  world::Plan plan = plan_;
  plan.name = name;
  std::vector<char> is_free(plan.cells.size());
  for (size_t i = 0; i < plan.cells.size(); ++i) is_free[i] = plan.cells[i] == world::Cell::kFree;
  const std::vector<world::RegionRun> runs = world::regionRuns(plan.columns, is_free);
  const size_t largest = runs.empty() ? 0 : world::largestRegionOf(runs);
  for (const world::RegionRun& run : runs)
    if (run.region != largest)
      std::fill(plan.cells.begin() + static_cast<std::ptrdiff_t>(run.begin),
                plan.cells.begin() + static_cast<std::ptrdiff_t>(run.end), world::Cell::kOccupied);
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

}  // namespace slam::buildings
