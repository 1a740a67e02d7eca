#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

#include "libslam/buildings/generator/site.h"

namespace slam::buildings {
namespace {

/// Cosine and sine of a house's turn as whole numbers over a third: Pythagorean triples, so that turned walls
/// are the same cells on any machine.
struct Turn {
  int cosine, sine, over;
};
constexpr Turn kStraight{1, 0, 1};
constexpr std::array<Turn, 4> kTurns = {{{40, 9, 41}, {40, -9, 41}, {12, 5, 13}, {12, -5, 13}}};

/// A long body with a wing at a side, entrances and windows as niches in its long sides. Cells; u along the
/// body and v across it, from its middle.
struct House {
  int x, y;
  bool lies;  ///< its body runs in x
  Turn turn;
  int half_length, half_depth;
  int wing_begin, wing_end, wing_depth;  ///< along u, beyond half_depth

  int reach() const { return half_length + half_depth + wing_depth; }
};

struct Niches {
  int window_pitch, window, window_depth;
  int entrance_pitch, entrance, entrance_depth;

  bool cut(int along, int from_front) const {
    return (from_front < window_depth && along % window_pitch < window) ||
           (from_front < entrance_depth && along % entrance_pitch < entrance);
  }
};

class Campus {
 public:
  explicit Campus(Site& site)
      : site_(site),
        random_(site.layout),
        width_(site.width),
        height_(site.height),
        niches_{site.cells(320),  site.cells(140), site.cells(15),
                site.cells(1600), site.cells(220), site.cells(90)},
        solid_(static_cast<size_t>(std::max(0, width_)) * std::max(0, height_), 0) {}

  void draw() {
    site_.requireInside("campus", site_.cells(1600), site_.cells(1200));
    layRim();
    layYards();
    for (const House& house : houses_) build(house);
    carve();
    site_.canvas.raiseWalls(site_.outer_wall);
    glaze();
    for (const Rect& yard : yards_) plant(yard);
    for (size_t i = 0; i < yards_.size(); ++i) furnishYard(yards_[i], i);
  }

 private:
  void fillSolid(const Rect& r) {
    for (int y = std::max(0, r.y0); y < std::min(height_, r.y1); ++y)
      for (int x = std::max(0, r.x0); x < std::min(width_, r.x1); ++x)
        solid_[static_cast<size_t>(y) * width_ + x] = 1;
  }

  /// Houses wall to wall all round, each with its own front line and a niche for the entrance.
  void layRim() {
    const int most = std::min(site_.cells(900), std::min(width_, height_) / 6);
    for (const Side side : {Side::kSouth, Side::kNorth, Side::kWest, Side::kEast}) {
      const bool in_x = side == Side::kSouth || side == Side::kNorth;
      const int length = in_x ? width_ : height_, across = in_x ? height_ : width_;
      for (const auto& [begin, end] : partition(random_, length, site_.cells(700), site_.cells(3400), 0)) {
        const int depth = pick(random_, 0, most), entrance = niches_.entrance;
        const int at = begin + pick(random_, 0, std::max(0, end - begin - entrance));
        for (int i = begin; i < end; ++i) {
          const bool is_entrance = i >= at && i < at + entrance;
          const bool is_window = (i - begin) % niches_.window_pitch < niches_.window;
          const int front =
              depth - (is_entrance ? niches_.entrance_depth : 0) - (is_window ? niches_.window_depth : 0);
          const bool is_low = side == Side::kSouth || side == Side::kWest;
          const int from = is_low ? 0 : across - front, to = is_low ? front : across;
          fillSolid(in_x ? Rect{i, from, i + 1, to} : Rect{from, i, to, i + 1});
        }
      }
    }
  }

  /// Yards in a net; between two of them mostly a house, shorter than the yard so that ways lead round it.
  void layYards() {
    const int usual = std::max(site_.room, site_.cells(2500));
    const int nx = std::max(1, (width_ + usual / 2) / usual), ny = std::max(1, (height_ + usual / 2) / usual);
    for (int k = 0; k < ny; ++k)
      for (int i = 0; i < nx; ++i) {
        const Rect yard{width_ * i / nx, height_ * k / ny, width_ * (i + 1) / nx, height_ * (k + 1) / ny};
        yards_.push_back(yard);
        site_.addRoom(yard, Use::kCorridor, Side::kSouth);
        if (i + 1 < nx) layHouse(yard.x1, (yard.y0 + yard.y1) / 2, yard.height(), false);
        if (k + 1 < ny) layHouse((yard.x0 + yard.x1) / 2, yard.y1, yard.width(), true);
      }
  }

  void layHouse(int x, int y, int along, bool lies) {
    const int depth = std::min(site_.cells(20 * pick(random_, 45, 80)), along / 4);
    const int gap = std::max(site_.corridor, along / 8) + depth / 2;
    const int most = along - 2 * gap, shift = pick(random_, -along / 16, along / 16);
    const int length = most * pick(random_, 55, 100) / 100;
    const bool is_there = random_.below(10) < 8, is_turned = random_.below(10) < 3;
    const Turn turn = is_turned ? kTurns[random_.below(kTurns.size())] : kStraight;
    const int wing_begin = pick(random_, -length / 2, length / 4),
              wing = pick(random_, length / 8, length / 3);
    const int wing_depth = random_.below(2) == 0 ? 0 : pick(random_, depth / 4, depth / 2);
    if (!is_there || length < site_.cells(600)) return;
    houses_.push_back({lies ? x : x + shift, lies ? y + shift : y, lies, turn, length / 2, depth / 2,
                       wing_begin, std::min(length / 2, wing_begin + wing), wing_depth});
  }

  void build(const House& h) {
    const int reach = h.reach();
    for (int y = std::max(0, h.y - reach); y < std::min(height_, h.y + reach); ++y)
      for (int x = std::max(0, h.x - reach); x < std::min(width_, h.x + reach); ++x) {
        const int dx = h.lies ? x - h.x : y - h.y, dy = h.lies ? y - h.y : h.x - x;
        const int u = (h.turn.cosine * dx + h.turn.sine * dy) / h.turn.over;
        const int v = (h.turn.cosine * dy - h.turn.sine * dx) / h.turn.over;
        if (isHouse(h, u, v)) solid_[static_cast<size_t>(y) * width_ + x] = 1;
      }
  }

  bool isHouse(const House& h, int u, int v) const {
    if (u < -h.half_length || u >= h.half_length || v < -h.half_depth) return false;
    const bool is_wing = u >= h.wing_begin && u < h.wing_end;
    const int front = h.half_depth + (is_wing ? h.wing_depth : 0);
    return v < front && !niches_.cut(u + h.half_length, std::min(front - 1 - v, v + h.half_depth));
  }

  void carve() {
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_;) {
        const char* row = solid_.data() + static_cast<size_t>(y) * width_;
        int end = x;
        while (end < width_ && row[end] == row[x]) ++end;
        if (!row[x]) site_.canvas.carve({x, y, end, y + 1});
        x = end;
      }
  }

  /// Shop windows: the middle half of the side of a straight house that has no wing.
  void glaze() {
    core::RandomStream random(site_.seed, "building glass");
    for (const House& h : houses_) {
      const bool is_glass = random.chance(site_.options.glass);
      if (!is_glass || h.turn.over != 1) continue;
      const int half = h.half_length / 2, thick = site_.cells(20) + niches_.window_depth;
      const Rect front = h.lies
                             ? Rect{h.x - half, h.y - h.half_depth, h.x + half, h.y - h.half_depth + thick}
                             : Rect{h.x + h.half_depth - thick, h.y - half, h.x + h.half_depth, h.y + half};
      site_.canvas.makeOf(world::Material::kGlass, {std::max(0, front.x0), std::max(0, front.y0),
                                                    std::min(width_, front.x1), std::min(height_, front.y1)});
    }
  }

  /// An avenue, single trees and lamp posts: they stand in every visit and without clutter.
  void plant(const Rect& yard) {
    const bool lies = yard.width() > yard.height();
    const int from = (lies ? yard.x0 : yard.y0) + site_.cells(400), to = lies ? yard.x1 : yard.y1;
    const int line = lies ? yard.y0 + yard.height() * pick(random_, 25, 75) / 100
                          : yard.x0 + yard.width() * pick(random_, 25, 75) / 100;
    const int spacing = site_.cells(20 * pick(random_, 35, 60)), trunk = 10 * pick(random_, 3, 5);
    const int lane = site_.cells(20 * pick(random_, 25, 40));
    const bool has_avenue = random_.below(10) < 6;
    for (int at = from; has_avenue && at + site_.cells(400) < to; at += spacing)
      for (const int side : {line, line + lane}) {
        const int thick = site_.cells(trunk + pick(random_, -8, 8)),
                  u = at + pick(random_, 0, site_.cells(40));
        const Rect tree{lies ? u : side, lies ? side : u, (lies ? u : side) + thick,
                        (lies ? side : u) + thick};
        if (isIn(tree)) site_.canvas.place(tree, Shape::kDisc);
      }
    const auto area = static_cast<std::int64_t>(yard.width()) * yard.height();
    const auto one_in = [&](int square_metres) {
      return static_cast<int>(
          area * 100 / (static_cast<std::int64_t>(site_.cells(1000)) * site_.cells(1000)) / square_metres);
    };
    for (int i = one_in(450); i > 0; --i) {
      const int thick = site_.cells(pick(random_, 25, 80));
      site_.canvas.placeInside(random_, yard, thick, thick, Shape::kDisc);
    }
    for (int i = one_in(700) + 1; i > 0; --i) {
      const int thick = site_.cells(pick(random_, 10, 18));
      site_.canvas.placeInside(random_, yard, thick, thick, Shape::kDisc);
    }
  }

  bool isIn(const Rect& r) const { return r.x0 > 0 && r.y0 > 0 && r.x1 < width_ && r.y1 < height_; }

  void furnishYard(const Rect& yard, size_t index) {
    core::RandomStream random(site_.seed, "building furniture yard " + std::to_string(index));
    const auto area = static_cast<std::int64_t>(yard.width()) * yard.height();
    const auto hectare_percent =
        static_cast<int>(area / site_.cells(1000) / site_.cells(1000));  // 100 m2 each
    for (int i = hectare_percent / 12 + 1; i > 0; --i) parkRow(random, yard);
    const auto some = [&](int count, int least_cm, int most_cm, int depth_cm, Shape shape) {
      for (; count > 0; --count) {
        const bool is_there = random.chance(site_.options.clutter), lies = random.below(2) == 0;
        const int length = site_.cells(pick(random, least_cm, most_cm)), depth = site_.cells(depth_cm);
        if (is_there)
          site_.canvas.placeInside(random, yard, lies ? length : depth, lies ? depth : length, shape);
      }
    };
    some(hectare_percent / 25, 400, 1400, 80, Shape::kSolid);     // hedges
    some(hectare_percent / 15 + 1, 160, 220, 50, Shape::kSolid);  // benches
    some(hectare_percent / 20, 150, 300, 120, Shape::kLegs);      // stands for bicycles, tables
    some(hectare_percent / 20, 50, 50, 50, Shape::kDisc);         // bins
  }

  /// Cars side by side in bays of 2.5 by 5 m, where the whole row leaves every way open.
  void parkRow(core::RandomStream& random, const Rect& yard) {
    const int bay = site_.cells(250), deep = site_.cells(500), count = pick(random, 3, 12);
    const bool lies = random.below(2) == 0;
    const int size_x = lies ? count * bay : deep, size_y = lies ? deep : count * bay;
    for (int i = 0; i < 12 && size_x < yard.width() && size_y < yard.height(); ++i) {
      const int x = pick(random, yard.x0, yard.x1 - size_x), y = pick(random, yard.y0, yard.y1 - size_y);
      if (!site_.canvas.leavesWaysOpen({x, y, x + size_x, y + size_y})) continue;
      for (int k = 0; k < count; ++k) {
        const bool is_there = random.chance(site_.options.clutter) && random.below(10) < 7;
        const int width = site_.cells(pick(random, 170, 190)), length = site_.cells(pick(random, 380, 480));
        const int u = k * bay + pick(random, 0, bay - width), v = pick(random, 0, deep - length);
        if (is_there)
          parkCar(lies ? Rect{x + u, y + v, x + u + width, y + v + length}
                       : Rect{x + v, y + u, x + v + length, y + u + width});
      }
      return;
    }
  }

  /// A body with its corners off.
  void parkCar(const Rect& r) {
    const int corner = site_.cells(25);
    site_.canvas.fill({r.x0 + corner, r.y0, r.x1 - corner, r.y1});
    site_.canvas.fill({r.x0, r.y0 + corner, r.x1, r.y1 - corner});
  }

  Site& site_;
  core::RandomStream& random_;
  int width_, height_;
  Niches niches_;
  std::vector<char> solid_;  ///< row-major: houses
  std::vector<Rect> yards_;
  std::vector<House> houses_;
};

}  // namespace

void drawCampus(Site& site) {
  Campus(site).draw();
}

}  // namespace slam::buildings
