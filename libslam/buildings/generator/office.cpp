#include <algorithm>

#include "libslam/buildings/generator/floor.h"
#include "libslam/buildings/generator/furniture.h"

namespace slam::buildings {
namespace {

class Office {
 public:
  explicit Office(Site& site) : site_(site), random_(site.layout) {}

  void draw() {
    const FloorPlan plan{site_.cells(520),  leastDepth(), site_.cells(900),
                         site_.cells(3400), leastRoom(),  site_.wall};
    const Floor floor = layFloor(site_, "office", plan);
    for (const Row& row : floor.rows) carveRow(row);
    for (size_t i = 0; i < floor.blocks.size(); ++i) carveBlock(floor.blocks[i].rect, i);
    site_.canvas.raiseWalls(site_.outer_wall);
    site_.glaze();
    furnish(site_);
    raisePillars();
    furnishCorridors(floor);
    site_.addWindows();
  }

 private:
  int leastDepth() const { return site_.cells(260); }
  int leastRoom() const { return std::max(site_.cells(220), site_.room * 7 / 10); }

  double area_m2(const Rect& r) const {
    return r.width() * site_.options.resolution_m * r.height() * site_.options.resolution_m;
  }

  Use useOf(const Rect& rect) {
    const auto chance = random_.below(100);
    const double area = area_m2(rect);
    if (area > 34) return chance < 55 ? Use::kMeeting : chance < 85 ? Use::kOffice : Use::kLounge;
    if (area < 10) return chance < 50 ? Use::kStore : Use::kOffice;
    return chance < 78   ? Use::kOffice
           : chance < 88 ? Use::kMeeting
           : chance < 94 ? Use::kLounge
                         : Use::kStore;
  }

  void carveRow(const Row& row) {
    const std::vector<RowRoom> rooms = cutRow(site_, row, leastRoom(), site_.room * 3 / 2);
    for (size_t i = 0; i < rooms.size(); ++i) {
      const RowRoom& room = rooms[i];
      site_.carveRoom(room.rect, useOf(room.rect), row.front);
      site_.addDoor(room.rect, row.front, room.low, room.high);
      // A few rooms are joined, which makes small loops.
      if (i > 0 && random_.below(8) == 0) joinWithNext(rooms[i - 1].rect, row.front);
    }
  }

  void joinWithNext(const Rect& room, Side front) {
    const bool runs_in_x = front == Side::kNorth || front == Side::kSouth;
    if (runs_in_x)
      site_.addDoor(room, Side::kEast, room.y0, room.y1);
    else
      site_.addDoor(room, Side::kNorth, room.x0, room.x1);
  }

  void carveBlock(const Rect& block, size_t index) {
    const bool is_deep = block.height() >= 2 * leastDepth() + site_.wall;
    const auto chance = random_.below(100);
    const bool has_core = index % 3 == 0;  // nobody walks far to the stairs
    if (has_core && is_deep && block.width() >= coreWidth() + 2 * leastRoom() + 2 * site_.wall)
      return carveCoreBlock(block);
    if (chance < 22) return carveOpenPlan(block);
    if (chance < 34 && index > 0 && is_deep && block.width() > site_.cells(1000))
      return carveCourtyard(block);
    for (const Row& row : rowsOf(site_, block, leastDepth(), site_.wall)) carveRow(row);
  }

  /// A light well: nobody enters it, the walls around it are outer walls.
  void carveCourtyard(const Rect& block) { site_.courts.push_back(block); }

  int lobby() const { return site_.cells(240); }
  int toilets() const { return site_.cells(340); }
  int shaft() const { return site_.cells(250); }
  int coreWidth() const { return shaft() + lobby() + toilets() + 2 * site_.wall; }

  /// Offices left and right of a core: shafts of lifts and stairs, a lobby that joins both corridors,
  /// toilets.
  void carveCoreBlock(const Rect& block) {
    const int w = site_.wall, spare = block.width() - coreWidth() - 2 * w;
    const int left = std::max(
        leastRoom(), std::min(spare - leastRoom(), spare / 2 + pick(random_, -spare / 6, spare / 6)));
    const int core = block.x0 + left + w;
    const Rect lobby_rect{core + shaft() + w, block.y0 - w, core + shaft() + w + lobby(), block.y1 + w};
    site_.canvas.carve(lobby_rect);
    lobbies_.push_back(lobby_rect);
    const int x = lobby_rect.x1 + w, cut = (block.y0 + block.y1) / 2;
    const Rect south{x, block.y0, x + toilets(), cut}, north{x, cut + w, x + toilets(), block.y1};
    for (const auto& [rect, front] : {std::pair(south, Side::kSouth), std::pair(north, Side::kNorth)}) {
      site_.carveRoom(rect, Use::kToilets, front);
      site_.addDoor(rect, front, rect.x0, rect.x1);
    }
    for (const Rect& part : {Rect{block.x0, block.y0, core - w, block.y1},
                             Rect{core + coreWidth() + w, block.y0, block.x1, block.y1}})
      for (const Row& row : rowsOf(site_, part, leastDepth(), site_.wall)) carveRow(row);
    // The doors of two lifts, shut: shallow niches towards the shaft.
    const int lift = site_.cells(110), middle = (block.y0 + block.y1) / 2;
    for (const int at : {middle - lift - site_.cells(40), middle + site_.cells(40)})
      niches_.push_back({lobby_rect.x0 - w / 2, at, lobby_rect.x0, at + lift});
    for (const Rect& niche : niches_) site_.canvas.carve(niche);
  }

  void carveOpenPlan(const Rect& block) {
    site_.carveRoom(block, Use::kOpenPlan, Side::kSouth);
    const int opening = site_.cells(160), pitch = site_.cells(900);
    for (const Side side : {Side::kSouth, Side::kNorth})
      for (int x = block.x0 + site_.nook; x + opening + site_.nook <= block.x1; x += pitch) {
        const int last = std::min(x + pitch, block.x1) - opening - site_.nook;
        site_.canvas.carveDoor(site_.doorway(block, side, pick(site_.doors, x, std::max(x, last)), opening));
      }
  }

  /// Open plans stand on pillars, whatever the furniture; some come up through desks.
  void raisePillars() {
    const int side = site_.cells(45), bay = site_.cells(720);
    for (const Room& room : site_.rooms) {
      if (room.use != Use::kOpenPlan) continue;
      const Rect& r = room.rect;
      const int nx = r.width() / bay, ny = r.height() / bay;
      for (int i = 1; i <= nx; ++i)
        for (int k = 1; k <= ny; ++k) {
          const int x = r.x0 + r.width() * i / (nx + 1) - side / 2,
                    y = r.y0 + r.height() * k / (ny + 1) - side / 2;
          site_.canvas.fill({x, y, x + side, y + side});
        }
    }
  }

  void furnishCorridors(const Floor& floor) {
    core::RandomStream random(site_.seed, "building furniture corridors");
    for (const Rect& corridor : floor.corridors) {
      const int pieces = std::max(corridor.width(), corridor.height()) / site_.cells(1000);
      for (int i = 0; i < pieces; ++i) {
        const bool is_plant = random.below(2) == 0, is_there = random.chance(site_.options.clutter);
        const int length = is_plant ? 40 : 20 * pick(random, 4, 7);
        if (is_there)
          site_.canvas.placeAlong(random, corridor, pickSide(random), site_.cells(length), site_.cells(40),
                                  is_plant ? Shape::kDisc : Shape::kSolid);
      }
    }
    for (const Rect& lobby : lobbies_)
      if (random.chance(site_.options.clutter))
        site_.canvas.placeAlong(random, lobby, Side::kEast, site_.cells(120), site_.cells(40));
  }

  Site& site_;
  core::RandomStream& random_;
  std::vector<Rect> lobbies_, niches_;
};

}  // namespace

void drawOffice(Site& site) {
  Office(site).draw();
}

}  // namespace slam::buildings
