#include <algorithm>

#include "libslam/world/generator/floor.h"
#include "libslam/world/generator/furniture.h"

namespace slam::world {
namespace {

/// A flat in coordinates of its own: u along its front from 0 to `length`, v from the front inwards to `depth`.
class Flat {
 public:
  Flat(Site& site, const Rect& rect, Side front)
      : site_(site), random_(site.layout), rect_(rect), front_(front) {
    const bool runs_in_x = front == Side::kNorth || front == Side::kSouth;
    length_ = runs_in_x ? rect.width() : rect.height();
    depth_ = runs_in_x ? rect.height() : rect.width();
  }

  /// The flat's front door lies between low and high (in u); no door when it is a house of its own.
  void carve(int low, int high, bool has_front_door) {
    const int entrance = length_ >= 2 * leastSide() + hall() + 2 * site_.wall && depth_ >= site_.cells(640)
                             ? carveAroundHall(low, high)
                             : carveStudio(low, high);
    if (has_front_door)
      site_.addDoor(toPlan(entrance, 0, entrance + hall(), 1), front_, toAlong(entrance),
                    toAlong(entrance) + hall());
  }

 private:
  int hall() const { return std::max(site_.cells(130), site_.door + 2 * site_.nook); }
  int leastSide() const { return site_.cells(200); }
  Side left() const { return front_ == Side::kNorth || front_ == Side::kSouth ? Side::kWest : Side::kSouth; }
  Side right() const { return opposite(left()); }

  Rect toPlan(int u0, int v0, int u1, int v1) const {
    switch (front_) {
      case Side::kSouth:
        return {rect_.x0 + u0, rect_.y0 + v0, rect_.x0 + u1, rect_.y0 + v1};
      case Side::kNorth:
        return {rect_.x0 + u0, rect_.y1 - v1, rect_.x0 + u1, rect_.y1 - v0};
      case Side::kWest:
        return {rect_.x0 + v0, rect_.y0 + u0, rect_.x0 + v1, rect_.y0 + u1};
      default:
        return {rect_.x1 - v1, rect_.y0 + u0, rect_.x1 - v0, rect_.y0 + u1};
    }
  }
  /// u as the plan's coordinate along the front.
  int toAlong(int u) const {
    return u + (front_ == Side::kNorth || front_ == Side::kSouth ? rect_.x0 : rect_.y0);
  }
  Rect carveRoom(int u0, int v0, int u1, int v1, Use use, Side front) {
    const Rect room = toPlan(u0, v0, u1, v1);
    site_.carveRoom(room, use, front);
    return room;
  }
  /// A door in a wall that runs inwards, somewhere along the room's v.
  void addSideDoor(const Rect& room, Side side) {
    const bool runs_in_x = front_ == Side::kNorth || front_ == Side::kSouth;
    site_.addDoor(room, side, runs_in_x ? room.y0 : room.x0, runs_in_x ? room.y1 : room.x1);
  }
  void addBackDoor(const Rect& room, int low, int high) {
    site_.addDoor(room, opposite(front_), toAlong(low), toAlong(high));
  }

  /// One room and a bath in the corner away from the entrance. Returns where the entrance is.
  int carveStudio(int low, int high) {
    const int bath_u = site_.cells(170), bath_v = site_.cells(210), w = site_.wall;
    const bool bath_at_left = low > bath_u + w || (high >= length_ && random_.below(2) == 0);
    const int b0 = bath_at_left ? 0 : length_ - bath_u, b1 = b0 + bath_u;
    const int entry0 = bath_at_left ? b1 + w : 0, entry1 = bath_at_left ? length_ : b0 - w;
    site_.canvas.carve(toPlan(entry0, 0, entry1, depth_));
    carveRoom(0, bath_v + w, length_, depth_, Use::kLiving, front_);
    site_.addRoom(toPlan(entry0, 0, entry1, bath_v), Use::kKitchen, bath_at_left ? left() : right());
    const Rect bath = carveRoom(b0, 0, b1, bath_v, Use::kBath, bath_at_left ? right() : left());
    addSideDoor(bath, bath_at_left ? right() : left());
    const int first = std::max(low, entry0), last = std::max(first, std::min(high, entry1) - hall());
    return pick(random_, first, last);
  }

  /// A hall from the entrance inwards, rooms on both sides of it, living room and kitchen across its end.
  int carveAroundHall(int low, int high) {
    const int w = site_.wall, spare = length_ - hall() - 2 * w;
    const int most_left = std::min(spare - leastSide(), high - hall() - w);
    const int left_width = std::clamp(pick(random_, spare * 3 / 10, spare * 7 / 10),
                                      std::min(std::max(leastSide(), low - w), most_left), most_left);
    const int h0 = left_width + w, h1 = h0 + hall();
    const int most_living = depth_ - w - site_.cells(260);
    const int living = std::clamp(depth_ * pick(random_, 38, 50) / 100, site_.cells(300),
                                  std::max(site_.cells(300), most_living));
    const int d = depth_ - living - w;
    site_.carveRoom(toPlan(h0, 0, h1, d), Use::kFlatHall, front_);
    const bool bath_at_left = left_width < length_ - h1 - w;
    carveColumn(0, left_width, d, right(), bath_at_left);
    carveColumn(h1 + w, length_, d, left(), !bath_at_left);
    carveLiving(h0, h1, d);
    return h0;
  }

  void carveColumn(int u0, int u1, int d, Side door, bool has_bath) {
    int v = 0;
    const int bath = site_.cells(pick(random_, 36, 48) * 5), least = site_.cells(240);
    if (has_bath) {
      const bool is_all = d - bath - site_.wall < least;
      const Rect room = carveRoom(u0, 0, u1, is_all ? d : bath, Use::kBath, door);
      addSideDoor(room, door);
      if (is_all) return;
      v = bath + site_.wall;
    }
    for (const auto& [begin, end] :
         partition(random_, d - v, least, std::max(least, site_.room * 5 / 4), site_.wall)) {
      const Rect room = carveRoom(u0, v + begin, u1, v + end, Use::kBedroom, door);
      addSideDoor(room, door);
    }
  }

  /// The living room at the end of the hall; a kitchen beside it, on the side that has room for it.
  void carveLiving(int h0, int h1, int d) {
    const int w = site_.wall, v0 = d + w;
    const int kitchen = site_.cells(pick(random_, 24, 34) * 10), least = site_.cells(320);
    const bool fits_left = kitchen + w <= h0 && length_ - kitchen - w >= least;
    const bool fits_right = length_ - kitchen - w >= h1 && length_ - kitchen - w >= least;
    int u0 = 0, u1 = length_;
    if (fits_left && (!fits_right || random_.below(2) == 0)) {
      const Rect room = carveRoom(0, v0, kitchen, depth_, Use::kKitchen, right());
      addSideDoor(room, right());
      u0 = kitchen + w;
    } else if (fits_right) {
      const Rect room = carveRoom(length_ - kitchen, v0, length_, depth_, Use::kKitchen, left());
      addSideDoor(room, left());
      u1 = length_ - kitchen - w;
    }
    carveRoom(u0, v0, u1, depth_, Use::kLiving, front_);
    addBackDoor(toPlan(h0, 0, h1, d), h0, h1);
  }

  Site& site_;
  core::RandomStream& random_;
  Rect rect_;
  Side front_;
  int length_, depth_;
};

}  // namespace

void drawFlats(Site& site) {
  site.requireInside("flat", site.cells(420), site.cells(420));
  const bool is_one = site.width <= site.cells(1500) && site.height <= site.cells(1200);
  if (is_one) {
    Flat(site, {0, 0, site.width, site.height}, Side::kSouth).carve(0, site.width, false);
  } else {
    const int least = site.cells(700);
    const FloorPlan plan{site.cells(850), site.cells(420), site.cells(1500), site.cells(4500), least};
    const Floor floor = layFloor(site, "flat", plan);
    std::vector<Row> rows = floor.rows;
    for (const Block& block : floor.blocks)
      for (const Row& row : rowsOf(site, block.rect, site.cells(420))) rows.push_back(row);
    for (const Row& row : rows) {
      const bool runs_in_x = row.front == Side::kNorth || row.front == Side::kSouth;
      for (const RowRoom& flat : cutRow(site, row, least, site.cells(1250))) {
        const int begin = runs_in_x ? flat.rect.x0 : flat.rect.y0;
        Flat(site, flat.rect, row.front).carve(flat.low - begin, flat.high - begin, true);
      }
    }
  }
  site.canvas.raiseWalls(site.outer_wall);
  site.glaze();
  furnish(site);
  site.addWindows();
}

}  // namespace slam::world
