#include "libslam/buildings/generator/site.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/error.h"

namespace slam::buildings {
namespace {

/// Metres from the command line as centimetres: from here on whole numbers.
int centimetres(double metres) {
  return static_cast<int>(std::lround(100 * metres));
}

/// At least half an inner wall, which is raised from both sides.
int outerWall(const BuildingOptions& options, const CanvasScale& scale) {
  return std::max(scale.cells(centimetres(options.outer_wall_m)),
                  (scale.cells(centimetres(options.wall_m)) + 1) / 2);
}

CanvasScale scaleOf(const BuildingOptions& options) {
  CanvasScale scale;
  scale.resolution_m = options.resolution_m;
  scale.rim = outerWall(options, scale) + 1;
  const int beside_robot = static_cast<int>(std::floor(kRobotRadius_m / options.resolution_m - 0.5)) + 1;
  scale.passage = 2 * beside_robot + 2 + scale.cells(15);
  return scale;
}

int inside(double side_m, const CanvasScale& scale) {
  return scale.cells(centimetres(side_m)) - 2 * scale.rim;
}

}  // namespace

Site::Site(const BuildingOptions& o, std::uint64_t building_seed)
    : options(o),
      seed(building_seed),
      layout(seed, "building layout"),
      doors(seed, "building doors"),
      canvas(inside(o.width_m, scaleOf(o)), inside(o.height_m, scaleOf(o)), scaleOf(o)),
      width(inside(o.width_m, scaleOf(o))),
      height(inside(o.height_m, scaleOf(o))),
      wall(cells(centimetres(o.wall_m))),
      outer_wall(outerWall(o, canvas.scale())),
      corridor(cells(centimetres(o.corridor_m))),
      door(std::max(cells(centimetres(o.door_m)), static_cast<int>(std::ceil(0.8 / o.resolution_m - 1e-9)))),
      room(cells(centimetres(o.room_m))),
      pillars(o.pillars_m > 0 ? cells(centimetres(o.pillars_m)) : 0),
      nook(cells(15)) {}

void Site::requireInside(const std::string& kind, int least_width, int least_height) const {
  if (width >= least_width && height >= least_height) return;
  const auto metres = [this](int cells_inside) {  // up to the next decimetre
    const double m = (cells_inside + 2 * canvas.scale().rim) * options.resolution_m;
    return files::formatNumber(std::max(5.0, std::ceil(m * 10 - 1e-6) / 10));
  };
  throw core::InputError("[building] width_m, height_m: found " + files::formatNumber(options.width_m) +
                         " x " + files::formatNumber(options.height_m) + ", expected at least " +
                         metres(std::max(least_width, least_height)) + " x " + metres(least_height) +
                         " for '" + kind + "', either way round");
}

Rect Site::doorway(const Rect& r, Side front, int at, int length) const {
  switch (front) {
    case Side::kNorth:
      return {at, r.y1, at + length, r.y1 + wall};
    case Side::kSouth:
      return {at, r.y0 - wall, at + length, r.y0};
    case Side::kEast:
      return {r.x1, at, r.x1 + wall, at + length};
    default:
      return {r.x0 - wall, at, r.x0, at + length};
  }
}

void Site::addDoor(const Rect& r, Side front, int low, int high) {
  const int first = low + nook, last = high - nook - door;
  const int at = first <= last ? pick(doors, first, last) : low + (high - low - door) / 2;
  canvas.carveDoor(doorway(r, front, at, door));
}

void Site::addRoom(const Rect& rect, Use use, Side front) {
  rooms.push_back({rect, use, front});
}

void Site::carveRoom(const Rect& rect, Use use, Side front) {
  canvas.carve(rect);
  addRoom(rect, use, front);
}

void Site::glaze() {
  core::RandomStream random(seed, "building glass");
  const int post = cells(20);
  for (const Room& r : rooms) {
    const bool is_glass = random.chance(options.glass);
    const Rect& rect = r.rect;
    const bool is_inside = r.front == Side::kWest    ? rect.x0 > 0
                           : r.front == Side::kEast  ? rect.x1 < width
                           : r.front == Side::kSouth ? rect.y0 > 0
                                                     : rect.y1 < height;
    if (!is_glass || !is_inside || r.use == Use::kCorridor) continue;
    const bool runs_in_x = r.front == Side::kNorth || r.front == Side::kSouth;
    const int begin = (runs_in_x ? r.rect.x0 : r.rect.y0) + post;
    const int end = (runs_in_x ? r.rect.x1 : r.rect.y1) - post;
    canvas.makeOf(world::Material::kGlass, doorway(r.rect, r.front, begin, end - begin));
  }
}

void Site::addWindows() {
  const int depth = std::min(cells(10), outer_wall - 2);
  const auto hollow = [&](const Rect& r, Side side, int length) {
    if (depth > 0) canvas.recess(r, side, length / 4, length - 2 * (length / 4), depth);
  };
  for (const Room& r : rooms) {
    if (r.rect.x0 == 0) hollow(r.rect, Side::kWest, r.rect.height());
    if (r.rect.x1 == width) hollow(r.rect, Side::kEast, r.rect.height());
    if (r.rect.y0 == 0) hollow(r.rect, Side::kSouth, r.rect.width());
    if (r.rect.y1 == height) hollow(r.rect, Side::kNorth, r.rect.width());
    for (const Rect& court : courts) {
      if (court.x0 > r.rect.x0 || court.x1 < r.rect.x1) continue;
      if (r.rect.y1 == court.y0) hollow(r.rect, Side::kNorth, r.rect.width());
      if (r.rect.y0 == court.y1) hollow(r.rect, Side::kSouth, r.rect.width());
    }
  }
}

}  // namespace slam::buildings
