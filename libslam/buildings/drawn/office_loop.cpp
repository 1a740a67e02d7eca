#include <vector>

#include "libslam/buildings/drawn/buildings.h"
#include "libslam/buildings/drawn/canvas.h"

namespace slam::buildings {
namespace {

constexpr int kWall = 3, kDoor = 19;
// The ring corridor, 2 m wide, runs around the core.
constexpr Rect kRing{100, 100, 700, 400}, kCore{143, 143, 657, 357};
constexpr int kLoungeBegin = 370, kLoungeEnd = 430;

struct Room {
  Rect rect;
  Side door;      ///< the wall to the corridor
  int low, high;  ///< cells along that wall, between which the door may lie
};

/// The building's rooms, and its corridor and lounge carved.
class Office {
 public:
  Office(Canvas& canvas, core::RandomStream& random) : canvas_(canvas), random_(random) {}

  void carve() {
    canvas_.carve({kRing.x0, kRing.y0, kRing.x1, kCore.y0 - kWall});
    canvas_.carve({kRing.x0, kCore.y1 + kWall, kRing.x1, kRing.y1});
    canvas_.carve({kRing.x0, kRing.y0, kCore.x0 - kWall, kRing.y1});
    canvas_.carve({kCore.x1 + kWall, kRing.y0, kRing.x1, kRing.y1});
    carveOuterRows();
    carveCore();
    for (const Room& room : rooms_) carveDoor(room);
  }

  void furnish() {
    for (const Room& room : rooms_) {
      if (room.rect.width() * room.rect.height() > 11500)
        furnishMeetingRoom(room);
      else
        furnishOffice(room);
    }
    const Rect lounge{kLoungeBegin, kCore.y0, kLoungeEnd, kCore.y1};
    canvas_.placeAlong(random_, lounge, Side::kWest, 40, 16);
    canvas_.placeAlong(random_, lounge, Side::kEast, 36, 8);
    canvas_.placeInside(random_, lounge, 10, 10, Shape::kDisc);
    furnishCorridor();
  }

 private:
  void addRoom(const Rect& rect, Side door, int low, int high) {
    canvas_.carve(rect);
    rooms_.push_back({rect, door, low, high});
  }

  void carveOuterRows() {
    for (const bool north : {false, true}) {
      const int y0 = north ? kRing.y1 + kWall : 0, y1 = north ? 500 : kRing.y0 - kWall;
      const Side door = north ? Side::kSouth : Side::kNorth;
      // The corner rooms reach past the corridor's corner, so that their doors open to it.
      const int first = pick(random_, 130, 150), last = 800 - pick(random_, 130, 150);
      addRoom({0, y0, first, y1}, door, kRing.x0 + 4, first - 4);
      for (const auto& [begin, end] : partition(random_, last - first - 2 * kWall, 75, 150, kWall))
        addRoom({first + kWall + begin, y0, first + kWall + end, y1}, door, first + kWall + begin + 4,
                first + kWall + end - 4);
      addRoom({last, y0, 800, y1}, door, last + 4, kRing.x1 - 4);
    }
    for (const bool east : {false, true}) {
      const int x0 = east ? kRing.x1 + kWall : 0, x1 = east ? 800 : kRing.x0 - kWall;
      for (const auto& [begin, end] : partition(random_, kRing.height(), 75, 130, kWall))
        addRoom({x0, kRing.y0 + begin, x1, kRing.y0 + end}, east ? Side::kWest : Side::kEast,
                kRing.y0 + begin + 4, kRing.y0 + end - 4);
    }
  }

  /// Two rows of rooms back to back, left and right of the lounge that joins both sides of the ring.
  void carveCore() {
    canvas_.carve({kLoungeBegin, kCore.y0 - kWall, kLoungeEnd, kCore.y1 + kWall});
    const int middle = (kCore.y0 + kCore.y1) / 2;
    for (const bool north : {false, true})
      for (const bool east : {false, true}) {
        const int x0 = east ? kLoungeEnd + kWall : kCore.x0, x1 = east ? kCore.x1 : kLoungeBegin - kWall;
        const int y0 = north ? middle + 1 : kCore.y0, y1 = north ? kCore.y1 : middle - 2;
        int index = 0;
        for (const auto& [begin, end] : partition(random_, x1 - x0, 60, 140, kWall)) {
          if (north && index++ == 1) continue;  // a shaft that nobody enters
          addRoom({x0 + begin, y0, x0 + end, y1}, north ? Side::kNorth : Side::kSouth, x0 + begin + 4,
                  x0 + end - 4);
        }
      }
  }

  void carveDoor(const Room& room) {
    const int at = pick(random_, room.low, room.high - kDoor);
    const Rect& r = room.rect;
    switch (room.door) {
      case Side::kNorth:
        return canvas_.carve({at, r.y1, at + kDoor, r.y1 + kWall});
      case Side::kSouth:
        return canvas_.carve({at, r.y0 - kWall, at + kDoor, r.y0});
      case Side::kEast:
        return canvas_.carve({r.x1, at, r.x1 + kWall, at + kDoor});
      case Side::kWest:
        return canvas_.carve({r.x0 - kWall, at, r.x0, at + kDoor});
    }
  }

  void furnishOffice(const Room& room) {
    for (int desks = pick(random_, 1, 3); desks > 0; --desks)
      canvas_.placeAlong(random_, room.rect, pickSide(random_), 28, 14, Shape::kDesk);
    const int shelf = pick(random_, 20, 40);
    canvas_.placeAlong(random_, room.rect, pickSide(random_), shelf, 8);
    if (random_.below(2) == 0) canvas_.placeAlong(random_, room.rect, pickSide(random_), 8, 8, Shape::kDisc);
  }

  void furnishMeetingRoom(const Room& room) {
    const Rect& r = room.rect;
    const bool is_wide = r.width() > r.height();
    const int half_length = pick(random_, 20, 26), half_width = 9;
    const int half_x = is_wide ? half_length : half_width, half_y = is_wide ? half_width : half_length;
    const int x = (r.x0 + r.x1) / 2, y = (r.y0 + r.y1) / 2;
    const Rect table{x - half_x, y - half_y, x + half_x, y + half_y};
    constexpr int kChair = 8, kSpread = 13;
    if (canvas_.leavesWaysOpen(
            {table.x0 - kChair, table.y0 - kChair, table.x1 + kChair, table.y1 + kChair})) {
      canvas_.fill(table);
      for (int along = -half_length + 3; along + kChair <= half_length; along += kSpread)
        for (const int across : {-half_width - kChair + 1, half_width - 1}) {
          const int cx = x + (is_wide ? along : across), cy = y + (is_wide ? across : along);
          canvas_.fillDisc({cx, cy, cx + kChair, cy + kChair});
        }
    }
    canvas_.placeAlong(random_, r, pickSide(random_), 36, 8);
    canvas_.placeAlong(random_, r, pickSide(random_), 8, 8, Shape::kDisc);
  }

  void furnishCorridor() {
    for (int pieces = 0; pieces < 10; ++pieces) {
      const Side wall = pickSide(random_);
      const bool is_plant = random_.below(2) == 0;
      canvas_.placeAlong(random_, kRing, wall, is_plant ? 8 : pick(random_, 16, 30), 8,
                         is_plant ? Shape::kDisc : Shape::kSolid);
    }
  }

  Canvas& canvas_;
  core::RandomStream& random_;
  std::vector<Room> rooms_;
};

}  // namespace

world::Plan makeOfficeLoop(std::uint64_t seed) {
  core::RandomStream random(seed, "office_loop");
  Canvas canvas(800, 500);
  Office office(canvas, random);
  office.carve();
  canvas.raiseWalls(4);
  office.furnish();
  return canvas.plan("office_loop");
}

}  // namespace slam::buildings
