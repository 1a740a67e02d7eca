#include "libslam/buildings/generator/furniture.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <string>

#include "libslam/buildings/generator/floor.h"

namespace slam::buildings {
namespace {

/// Where a piece stands: with its back to some wall, to the wall opposite the door or beside it; in a corner;
/// or free on all sides.
enum class Spot { kWall, kBack, kSide, kCorner, kInside };

struct Piece {
  Shape shape;
  Spot spot;
  int length_cm, depth_cm;  ///< along the wall and away from it
  int least, most;          ///< how many
};

constexpr Piece kPlant{Shape::kDisc, Spot::kCorner, 45, 45, 0, 1};
constexpr Piece kBookshelf{Shape::kSolid, Spot::kWall, 160, 35, 0, 2};
constexpr Piece kWardrobe{Shape::kSolid, Spot::kSide, 180, 60, 1, 1};

/// Large pieces first: the small ones find their place beside them. Sizes are those of usual furniture.
constexpr Piece kOffice[] = {{Shape::kDesk, Spot::kSide, 140, 70, 1, 2},
                             {Shape::kDesk, Spot::kBack, 140, 70, 0, 1},
                             {Shape::kSolid, Spot::kWall, 160, 45, 1, 2},
                             {Shape::kDisc, Spot::kInside, 45, 45, 0, 1},
                             kPlant};
constexpr Piece kMeeting[] = {{Shape::kSolid, Spot::kWall, 180, 45, 0, 1}, kPlant, kPlant};
constexpr Piece kLounge[] = {{Shape::kSolid, Spot::kCorner, 300, 60, 1, 1},
                             {Shape::kSolid, Spot::kSide, 200, 85, 0, 2},
                             {Shape::kLegs, Spot::kInside, 90, 90, 0, 2},
                             kPlant};
constexpr Piece kToilets[] = {{Shape::kSolid, Spot::kBack, 95, 150, 2, 3},
                              {Shape::kSolid, Spot::kSide, 140, 50, 1, 1}};
constexpr Piece kStore[] = {{Shape::kSolid, Spot::kSide, 200, 50, 1, 2},
                            {Shape::kSolid, Spot::kBack, 150, 50, 0, 1},
                            {Shape::kSolid, Spot::kWall, 60, 60, 0, 3}};
constexpr Piece kStudio[] = {{Shape::kSolid, Spot::kCorner, 200, 140, 1, 1},
                             {Shape::kLegs, Spot::kInside, 90, 80, 1, 1},
                             kWardrobe,
                             {Shape::kDesk, Spot::kWall, 120, 65, 0, 1},
                             {Shape::kSolid, Spot::kWall, 180, 85, 0, 1}};
constexpr Piece kLiving[] = {{Shape::kSolid, Spot::kSide, 220, 90, 1, 1},
                             {Shape::kSolid, Spot::kWall, 160, 40, 1, 2},
                             {Shape::kLegs, Spot::kInside, 160, 90, 1, 1},
                             {Shape::kSolid, Spot::kWall, 90, 90, 0, 1},
                             kPlant};
constexpr Piece kKitchen[] = {{Shape::kSolid, Spot::kBack, 240, 60, 1, 1},
                              {Shape::kSolid, Spot::kCorner, 180, 60, 1, 1},
                              {Shape::kLegs, Spot::kInside, 110, 75, 0, 1}};
constexpr Piece kBedroom[] = {{Shape::kSolid, Spot::kSide, 160, 200, 1, 1},
                              kWardrobe,
                              {Shape::kDesk, Spot::kBack, 120, 65, 0, 1},
                              {Shape::kSolid, Spot::kWall, 90, 45, 0, 1},
                              kBookshelf};
constexpr Piece kBath[] = {{Shape::kSolid, Spot::kCorner, 170, 75, 0, 1},
                           {Shape::kSolid, Spot::kSide, 40, 65, 1, 1},
                           {Shape::kSolid, Spot::kWall, 60, 45, 1, 1}};
constexpr Piece kFlatHall[] = {{Shape::kSolid, Spot::kSide, 90, 30, 0, 1}};
constexpr Piece kNurses[] = {{Shape::kDesk, Spot::kSide, 140, 70, 1, 2},
                             {Shape::kSolid, Spot::kBack, 200, 50, 1, 1},
                             {Shape::kSolid, Spot::kWall, 60, 60, 0, 2}};
constexpr Piece kWard[] = {{Shape::kSolid, Spot::kWall, 60, 60, 0, 1},
                           {Shape::kDisc, Spot::kInside, 50, 50, 0, 1}};
constexpr Piece kWaiting[] = {{Shape::kSolid, Spot::kBack, 220, 60, 1, 1},
                              {Shape::kSolid, Spot::kSide, 160, 60, 1, 2},
                              {Shape::kLegs, Spot::kInside, 70, 70, 0, 1},
                              kPlant};
/// One of these lists.
class Pieces {
 public:
  constexpr Pieces() = default;
  template <std::size_t kCount>
  constexpr Pieces(const Piece (&pieces)[kCount]) : begin_(pieces), end_(pieces + kCount) {}
  const Piece* begin() const { return begin_; }
  const Piece* end() const { return end_; }

 private:
  const Piece *begin_ = nullptr, *end_ = nullptr;
};

Pieces piecesOf(Use use) {
  switch (use) {
    case Use::kOffice:
      return kOffice;
    case Use::kMeeting:
      return kMeeting;
    case Use::kLounge:
      return kLounge;
    case Use::kToilets:
      return kToilets;
    case Use::kStore:
      return kStore;
    case Use::kStudio:
      return kStudio;
    case Use::kLiving:
      return kLiving;
    case Use::kKitchen:
      return kKitchen;
    case Use::kBedroom:
      return kBedroom;
    case Use::kBath:
      return kBath;
    case Use::kFlatHall:
      return kFlatHall;
    case Use::kNurses:
      return kNurses;
    case Use::kWard:
      return kWard;
    case Use::kWaiting:
      return kWaiting;
    default:
      return {};
  }
}

Side sideOf(core::RandomStream& random, Side front) {
  const bool runs_in_x = front == Side::kNorth || front == Side::kSouth;
  const bool first = random.below(2) == 0;
  if (runs_in_x) return first ? Side::kWest : Side::kEast;
  return first ? Side::kSouth : Side::kNorth;
}

void placeInCorner(Site& site, core::RandomStream& random, const Rect& r, const Piece& piece) {
  const int length = site.cells(piece.length_cm), depth = site.cells(piece.depth_cm);
  for (int i = 0; i < 8; ++i) {
    const Side wall = pickSide(random);
    const int along = wall == Side::kNorth || wall == Side::kSouth ? r.width() : r.height();
    if (length <= along &&
        site.canvas.placeAt(r, wall, random.below(2) == 0 ? 0 : along - length, length, depth, piece.shape))
      return;
  }
}

void placePiece(Site& site, core::RandomStream& random, const Room& room, const Piece& piece) {
  const int length = site.cells(piece.length_cm), depth = site.cells(piece.depth_cm);
  Canvas& canvas = site.canvas;
  switch (piece.spot) {
    case Spot::kCorner:
      return placeInCorner(site, random, room.rect, piece);
    case Spot::kInside: {
      const bool lies = random.below(2) == 0;
      canvas.placeInside(random, room.rect, lies ? length : depth, lies ? depth : length, piece.shape);
      return;
    }
    case Spot::kWall:
      canvas.placeAlong(random, room.rect, pickSide(random), length, depth, piece.shape);
      return;
    case Spot::kBack:
      canvas.placeAlong(random, room.rect, opposite(room.front), length, depth, piece.shape);
      return;
    case Spot::kSide:
      canvas.placeAlong(random, room.rect, sideOf(random, room.front), length, depth, piece.shape);
      return;
  }
}

/// Two rows of desks face to face over the screen between them, drawers and chairs so close that no robot
/// fits in between.
void drawIsland(Site& site, core::RandomStream& random, int x, int y, int desks) {
  const int desk = site.cells(150), half = site.cells(65), drawers = site.cells(40), chair = site.cells(45);
  const int screen = site.cells(10) / 2 + 1;
  site.canvas.fill({x, y - screen, x + desks * desk, y + screen});
  for (int x0 = x; x0 < x + desks * desk; x0 += desk)
    for (const bool is_north : {false, true}) {
      const int front = is_north ? y + half : y - half;
      site.canvas.fill({x0, std::min(y, front), x0 + drawers, std::max(y, front)});
      const int seat_x = x0 + drawers + (desk - drawers - chair) / 2,
                seat_y = front - chair / 2 + pick(random, -1, 1);
      site.canvas.fillDisc({seat_x, seat_y, seat_x + chair, seat_y + chair});
    }
}

/// Islands of desks in rows and columns, cupboards along the walls.
void furnishOpenPlan(Site& site, core::RandomStream& random, const Rect& r) {
  const int desk = site.cells(150), reach = site.cells(65) + site.cells(45);
  const int way = site.canvas.scale().passage + site.cells(50);
  const int rows = (r.height() - way) / (2 * reach + way);
  for (int x = r.x0 + way; x + 2 * desk + way <= r.x1;) {
    const int desks = std::min(pick(random, 2, 4), (r.x1 - way - x) / desk);
    for (int row = 0; row < rows; ++row) {
      const int y = r.y0 + (r.height() - way) * (2 * row + 1) / (2 * rows) + way / 2;
      const bool is_there = random.chance(site.options.clutter);
      if (is_there && site.canvas.leavesWaysOpen({x, y - reach, x + desks * desk, y + reach}))
        drawIsland(site, random, x, y, desks);
    }
    x += desks * desk + way;
  }
  for (int i = r.width() / site.cells(500); i > 0; --i)
    if (random.chance(site.options.clutter))
      site.canvas.placeAlong(random, r, pickSide(random), site.cells(160), site.cells(45));
}

/// Nobody puts a cupboard where a door opens: a step's length before and behind every door.
std::vector<Rect> waysThroughDoors(const Site& site) {
  const int step = site.cells(90);
  std::vector<Rect> ways = site.canvas.doors();
  for (Rect& way : ways) {
    const bool runs_in_x = way.width() > way.height();
    (runs_in_x ? way.y0 : way.x0) -= step, (runs_in_x ? way.y1 : way.x1) += step;
  }
  return ways;
}

/// A piece list is for a room of some 18 m2; offices and the like that are larger get it again.
int timesFurnished(const Site& site, const Room& room) {
  const bool repeats = room.use == Use::kOffice || room.use == Use::kLounge || room.use == Use::kStore ||
                       room.use == Use::kNurses || room.use == Use::kWaiting;
  const std::int64_t area = static_cast<std::int64_t>(room.rect.width()) * room.rect.height();
  const std::int64_t usual = static_cast<std::int64_t>(site.cells(450)) * site.cells(400);
  return repeats ? static_cast<int>(std::clamp<std::int64_t>((area + usual / 2) / usual, 1, 6)) : 1;
}

}  // namespace

void placeTable(Site& site, const Rect& r, int length_cm, int depth_cm) {
  const bool lies = r.width() > r.height();
  const int length = site.cells(length_cm), depth = site.cells(depth_cm), chair = site.cells(40);
  const int size_x = lies ? length : depth, size_y = lies ? depth : length;
  const int x = (r.x0 + r.x1 - size_x) / 2, y = (r.y0 + r.y1 - size_y) / 2;
  const Rect table{x, y, x + size_x, y + size_y};
  if (!site.canvas.leavesWaysOpen({x - chair, y - chair, table.x1 + chair, table.y1 + chair})) return;
  site.canvas.fill(table);
  const int spread = site.cells(65);
  for (int along = (length % spread + spread - chair) / 2; along + chair <= length; along += spread)
    for (const int across : {1 - chair, depth - 1}) {
      const int cx = x + (lies ? along : across), cy = y + (lies ? across : along);
      site.canvas.fillDisc({cx, cy, cx + chair, cy + chair});
    }
}

void furnish(Site& site) {
  const std::vector<Rect> ways = waysThroughDoors(site);
  for (size_t i = 0; i < site.rooms.size(); ++i) {
    const Room& room = site.rooms[i];
    core::RandomStream random(site.seed, "building furniture " + std::to_string(i));
    std::vector<Rect> own_ways;
    std::copy_if(ways.begin(), ways.end(), std::back_inserter(own_ways),
                 [&room](const Rect& way) { return way.overlaps(room.rect); });
    site.canvas.keepFree(own_ways);
    if (room.use == Use::kOpenPlan) furnishOpenPlan(site, random, room.rect);
    if (room.use == Use::kMeeting && random.chance(site.options.clutter))
      placeTable(site, room.rect, pick(random, 10, 16) * 20, 100);
    const int often = timesFurnished(site, room);
    for (const Piece& piece : piecesOf(room.use))
      for (int count = often * pick(random, piece.least, piece.most); count > 0; --count)
        if (random.chance(site.options.clutter)) placePiece(site, random, room, piece);
  }
  site.canvas.keepFree({});
}

}  // namespace slam::buildings
