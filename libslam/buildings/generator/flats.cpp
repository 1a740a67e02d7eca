#include <algorithm>

#include "libslam/buildings/generator/floor.h"
#include "libslam/buildings/generator/furniture.h"

namespace slam::buildings {
namespace {

/// A flat in coordinates of its own: u along its front from 0 to `length`, v from the front inwards to
/// `depth`.
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
    const int entrance = length_ >= 2 * leastSide() + hall() + 2 * site_.wall && depth_ >= site_.cells(580)
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
    carveRoom(0, bath_v + w, length_, depth_, Use::kStudio, front_);
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

  /// Rooms one behind the other along the hall. A column that is too wide for that has an outer part, one
  /// room that is entered from the living room.
  void carveColumn(int u0, int u1, int d, Side door, bool has_bath) {
    const int w = site_.wall, inner = site_.cells(pick(random_, 26, 36) * 10);
    if (u1 - u0 >= inner + w + site_.cells(260)) {
      const bool hall_is_right = door == right();
      const int o0 = hall_is_right ? u0 : u0 + inner + w, o1 = hall_is_right ? u1 - inner - w : u1;
      for (const auto& [begin, end] :
           partition(random_, o1 - o0, site_.cells(260), std::max(site_.cells(260), site_.room * 3 / 2), w))
        outer_.push_back(carveRoom(o0 + begin, 0, o0 + end, d, Use::kBedroom, opposite(front_)));
      (hall_is_right ? u0 : u1) = hall_is_right ? u1 - inner : u0 + inner;
    }
    int v = 0;
    const int bath = site_.cells(pick(random_, 36, 48) * 5), least = site_.cells(240);
    if (has_bath) {
      const bool is_all = d - bath - w < least;
      const Rect room = carveRoom(u0, 0, u1, is_all ? d : bath, Use::kBath, door);
      addSideDoor(room, door);
      if (is_all) return;
      v = bath + w;
    }
    for (const auto& [begin, end] :
         partition(random_, d - v, least, std::max(least, site_.room * 5 / 4), w)) {
      const Rect room = carveRoom(u0, v + begin, u1, v + end, Use::kBedroom, door);
      addSideDoor(room, door);
    }
  }

  /// The living room at the end of the hall, across the flat; at its ends a kitchen and in long flats one
  /// more room, both entered from it. The rooms of outer_ open to it where they lie along it, else to its
  /// neighbour.
  void carveLiving(int h0, int h1, int d) {
    const int w = site_.wall, v0 = d + w, least = site_.cells(320);
    int u0 = 0, u1 = length_;
    const auto cut = [&](bool at_left, int size, Use use) {
      const bool leaves_hall = at_left ? u0 + size + w <= h0 : u1 - size - w >= h1;
      if (!leaves_hall || u1 - u0 - size - w < least) return false;
      const int begin = at_left ? u0 : u1 - size;
      const Rect room = carveRoom(begin, v0, begin + size, depth_, use, at_left ? right() : left());
      addSideDoor(room, at_left ? right() : left());
      cuts_.push_back(at_left ? begin + size : begin - w);
      (at_left ? u0 : u1) = at_left ? begin + size + w : begin - w;
      return true;
    };
    const bool kitchen_at_left = random_.below(2) == 0;
    const int kitchen = site_.cells(pick(random_, 24, 34) * 10);
    const bool has_kitchen =
        cut(kitchen_at_left, kitchen, Use::kKitchen) || cut(!kitchen_at_left, kitchen, Use::kKitchen);
    for (int more = 0; has_kitchen && more < 3 && u1 - u0 > site_.cells(720); ++more) {
      const int size = site_.cells(pick(random_, 28, 40) * 10);
      const bool at_left = u0 < length_ - u1;  // the side away from the kitchen first
      if (!cut(at_left, size, Use::kBedroom) && !cut(!at_left, size, Use::kBedroom)) break;
    }
    carveRoom(u0, v0, u1, depth_, Use::kLiving, front_);
    addBackDoor(toPlan(h0, 0, h1, d), h0, h1);
    for (const Rect& room : outer_) {
      const int begin = fromPlan(room),
                length = front_ == Side::kNorth || front_ == Side::kSouth ? room.width() : room.height();
      openToBack(room, begin, begin + length);
    }
  }

  /// The longest part of the room's back wall that no wall across it meets gets the door.
  void openToBack(const Rect& room, int begin, int end) {
    std::vector<int> ends = {begin - site_.wall};
    for (const int cut : cuts_)
      if (cut > begin - site_.wall && cut < end) ends.push_back(cut);
    ends.push_back(end);
    std::sort(ends.begin(), ends.end());
    size_t widest = 1;
    for (size_t i = 1; i < ends.size(); ++i)
      if (ends[i] - ends[i - 1] > ends[widest] - ends[widest - 1]) widest = i;
    addBackDoor(room, ends[widest - 1] + site_.wall, ends[widest]);
  }

  int fromPlan(const Rect& room) const {
    return front_ == Side::kNorth || front_ == Side::kSouth ? room.x0 - rect_.x0 : room.y0 - rect_.y0;
  }

  Site& site_;
  core::RandomStream& random_;
  Rect rect_;
  Side front_;
  int length_, depth_;
  std::vector<Rect> outer_;  ///< rooms without a wall to the hall
  std::vector<int> cuts_;    ///< where walls across the back begin, in u
};

}  // namespace

void drawFlats(Site& site) {
  site.requireInside("flat", site.cells(420), site.cells(420));
  const bool is_one = site.width <= site.cells(1500) && site.height <= site.cells(1200);
  if (is_one) {
    Flat(site, {0, 0, site.width, site.height}, Side::kSouth).carve(0, site.width, false);
  } else {
    const int least = site.cells(700), court = site.cells(600);
    const FloorPlan plan{site.cells(850), site.cells(420), site.cells(1500), site.cells(4500), least, court};
    const Floor floor = layFloor(site, "flat", plan);
    std::vector<Row> rows = floor.rows;
    for (const Block& block : floor.blocks)
      for (const Row& row : rowsOf(site, block.rect, site.cells(420), court)) rows.push_back(row);
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

}  // namespace slam::buildings
