#include <algorithm>
#include <cstdlib>
#include <limits>

#include "libslam/buildings/generator/floor.h"
#include "libslam/buildings/generator/furniture.h"

namespace slam::buildings {
namespace {

/// From south to north: how many corridors, and what lies between two of them.
struct Section {
  int corridors = 0;
  int rows_between = 1;  ///< one row, or two back to back or on both sides of a court
  int depth = 0;         ///< of a row
  int court = 0;         ///< 0 = none
};

/// Everything is drawn in the western half and mirrored to the eastern one.
class Hospital {
 public:
  explicit Hospital(Site& site) : site_(site) {}

  void draw() {
    const Section section = chooseSection();
    layCrossCorridors();
    const int w = site_.wall, c = site_.corridor;
    int y = 0;
    for (int k = 0; k < section.corridors; ++k) {
      if (k == 0) carveRow(y, section.depth, Side::kNorth), y += section.depth + w;
      site_.canvas.carve({0, y, site_.width, y + c});
      corridors_.push_back({0, y, site_.width, y + c});
      y += c + w;
      const bool is_top = k + 1 == section.corridors;
      const int depth = is_top ? site_.height - y : section.depth;
      carveRow(y, depth, Side::kSouth);
      y += depth + (section.court > 0 ? section.court : w);
      if (section.court > 0 && !is_top) site_.courts.push_back({0, y - section.court, site_.width, y});
      if (is_top) break;
      if (section.rows_between == 2) carveRow(y, section.depth, Side::kNorth), y += section.depth + w;
    }
    for (const auto& [x0, x1] : crossings_) {
      site_.canvas.carve({x0, 0, x1, site_.height});
      site_.canvas.carve({site_.width - x1, 0, site_.width - x0, site_.height});
    }
    site_.canvas.raiseWalls(site_.outer_wall);
    site_.glaze();
    for (const Rect& piece : fixtures_)
      if (site_.options.clutter > 0) site_.canvas.place(piece);
    furnish(site_);
    furnishCorridors();
    site_.addWindows();
  }

 private:
  int leastDepth() const { return site_.cells(450); }
  int bathLength() const { return site_.cells(150); }
  /// Beside a ward's bathroom there is its entrance.
  int leastWard() const { return bathLength() + 2 * site_.wall + site_.door + 2 * site_.nook; }
  int usualWard() const { return std::max(site_.room, leastWard()); }
  int strip() const { return site_.corridor + 2 * site_.wall; }

  /// The section that comes nearest to usual rows and courts.
  Section chooseSection() const {
    const int w = site_.wall, usual = site_.cells(560), usual_court = site_.cells(800);
    site_.requireInside("hospital", 2 * usualWard() + strip(), strip() + 2 * leastDepth());
    Section best;
    int least = std::numeric_limits<int>::max();
    const auto consider = [&](const Section& section, int penalty) {
      if (penalty < least) least = penalty, best = section;
    };
    for (int n = 1; n * strip() < site_.height; ++n)
      for (const int between : {1, 2}) {
        if (n == 1 && between == 2) continue;  // there is nothing in between
        const int rows = 2 + (n - 1) * between;
        const int depth = (site_.height - n * strip() - (n - 1) * (between - 1) * w) / rows;
        if (depth >= leastDepth())
          consider({n, between, depth, 0}, std::abs(depth - usual) + site_.cells(30));
        if (between == 1 || n == 1) continue;
        const int court = (site_.height - n * strip() - rows * usual) / (n - 1);
        if (court >= site_.cells(400)) consider({n, 2, usual, court}, std::abs(court - usual_court) / 10);
      }
    return best;
  }

  /// One in the middle and, where there is room, one in each half; the segments between them get the rooms.
  void layCrossCorridors() {
    const int w = site_.wall, c = site_.corridor;
    const int middle = (site_.width - c) / 2;
    crossings_.push_back({middle, site_.width - middle});
    const int half = middle - w, least = 3 * usualWard();
    if (half < 2 * least + strip()) {
      segments_.push_back({0, half});
      return;
    }
    const int cut = std::max(least, (half - strip()) * pick(site_.layout, 30, 45) / 100);
    segments_ = {{0, cut}, {cut + strip(), half}};
    crossings_.push_back({cut + w, cut + w + c});
  }

  /// Equal rooms in every segment, every second one mirrored; next to the middle a room of the staff.
  void carveRow(int y, int depth, Side front) {
    for (size_t s = 0; s < segments_.size(); ++s) {
      const auto [begin, end] = segments_[s];
      const int w = site_.wall, length = end - begin + w;
      const int count =
          std::clamp((length + usualWard() / 2) / usualWard(), 1, std::max(1, length / leastWard()));
      for (int i = 0; i < count; ++i) {
        const int x0 = begin + length * i / count, x1 = begin + length * (i + 1) / count - w;
        const bool is_staff = s + 1 == segments_.size() && i + 1 == count;
        carveBoth({x0, y, x1, y + depth}, front, i % 2 == 1, is_staff);
      }
    }
  }

  void carveBoth(const Rect& room, Side front, bool is_mirrored, bool is_staff) {
    const Rect twin{site_.width - room.x1, room.y0, site_.width - room.x0, room.y1};
    if (is_staff) {
      const Use use = front == Side::kNorth ? Use::kNurses : Use::kWaiting;
      const int shift = (room.width() - site_.door) / 2;
      for (const Rect& r : {room, twin}) {
        site_.carveRoom(r, use, front);
        const int at = r.x0 == room.x0 ? r.x0 + shift : r.x1 - shift - site_.door;
        site_.canvas.carveDoor(site_.doorway(r, front, at, site_.door));
      }
      return;
    }
    carveWard(room, front, is_mirrored);
    carveWard(twin, front, !is_mirrored);
  }

  /// A bathroom beside the entrance, the beds behind it with their heads at its wall's side.
  void carveWard(const Rect& r, Side front, bool is_mirrored) {
    const int w = site_.wall, bath_u = bathLength(), bath_v = site_.cells(185);
    // u along the corridor from the bathroom's side, v away from it.
    const auto toPlan = [&](int u0, int v0, int u1, int v1) {
      const int x0 = is_mirrored ? r.x1 - u1 : r.x0 + u0, x1 = is_mirrored ? r.x1 - u0 : r.x0 + u1;
      return front == Side::kSouth ? Rect{x0, r.y0 + v0, x1, r.y0 + v1} : Rect{x0, r.y1 - v1, x1, r.y1 - v0};
    };
    const int length = r.width(), depth = r.height();
    const Rect entry = toPlan(bath_u + w, 0, length, bath_v + w), bath = toPlan(0, 0, bath_u, bath_v);
    const Rect main = toPlan(0, bath_v + w, length, depth);
    site_.canvas.carve(entry);
    site_.carveRoom(main, Use::kWard, front);
    site_.canvas.carve(bath);
    const Side to_entry = is_mirrored ? Side::kWest : Side::kEast;
    const int bath_door = std::min(site_.door, site_.cells(90));
    site_.canvas.carveDoor(
        site_.doorway(bath, to_entry, bath.y0 + (bath.height() - bath_door) / 2, bath_door));
    // The entrance keeps to the side away from the bathroom's door.
    const int at = is_mirrored ? entry.x0 + site_.nook : entry.x1 - site_.nook - site_.door;
    site_.canvas.carveDoor(site_.doorway(r, front, at, site_.door));
    const int bed_length = site_.cells(205), bed_width = site_.cells(95);
    const int spare = depth - bath_v - w, beds = std::max(1, spare / site_.cells(215));
    for (int i = 0; i < beds; ++i) {
      const int v = bath_v + w + (spare * (2 * i + 1) / beds - bed_width) / 2;
      fixtures_.push_back(toPlan(0, v, bed_length, v + bed_width));
    }
    const int wardrobe = site_.cells(60);
    fixtures_.push_back(toPlan(length - wardrobe, depth - site_.cells(110), length, depth));
    fixtures_.push_back(toPlan(0, 0, site_.cells(40), site_.cells(50)));  // basin
  }

  /// Little stands in them, and not the same in both halves: all that tells one place from another.
  void furnishCorridors() {
    core::RandomStream random(site_.seed, "building furniture corridors");
    for (const Rect& corridor : corridors_)
      for (int i = site_.width / site_.cells(1500); i > 0; --i) {
        const int length = 20 * pick(random, 3, 10);
        const bool is_there = random.chance(site_.options.clutter), is_north = random.below(2) == 0;
        if (is_there)
          site_.canvas.placeAlong(random, corridor, is_north ? Side::kNorth : Side::kSouth,
                                  site_.cells(length), site_.cells(length > 100 ? 80 : 50));
      }
  }

  Site& site_;
  std::vector<std::pair<int, int>> segments_, crossings_;  ///< [begin, end) in x, western half and middle
  std::vector<Rect> fixtures_;                             ///< of every ward the same
  std::vector<Rect> corridors_;
};

}  // namespace

void drawHospital(Site& site) {
  Hospital(site).draw();
}

}  // namespace slam::buildings
