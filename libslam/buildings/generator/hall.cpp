#include <algorithm>

#include "libslam/buildings/generator/furniture.h"

namespace slam::buildings {
namespace {

class Hall {
 public:
  explicit Hall(Site& site) : site_(site) {}

  void draw() {
    site_.requireInside("hall", site_.cells(900), site_.cells(700));
    cutSections();
    site_.canvas.raiseWalls(site_.outer_wall);
    site_.glaze();
    for (size_t i = 0; i < sections_.size(); ++i) furnishSection(sections_[i], i);
    furnish(site_);
    hollowGates();
  }

 private:
  /// Equal sections with fire walls between them, each open to the next one in x and in y by gates; an office
  /// in the corner of the first.
  void cutSections() {
    const int w = site_.wall;
    const bool is_open = site_.pillars > 0;
    const int usual = is_open ? std::max(site_.width, site_.height) : std::max(site_.room, site_.cells(1000));
    const int nx = std::max(1, (site_.width + usual / 2) / usual);
    const int ny = std::max(1, (site_.height + usual / 2) / usual);
    for (int k = 0; k < ny; ++k)
      for (int i = 0; i < nx; ++i) {
        const Rect section{(site_.width + w) * i / nx, (site_.height + w) * k / ny,
                           (site_.width + w) * (i + 1) / nx - w, (site_.height + w) * (k + 1) / ny - w};
        sections_.push_back(section);
        if (i + 1 < nx) addGates(section, Side::kEast, section.y0, section.y1);
        if (k + 1 < ny) addGates(section, Side::kNorth, section.x0, section.x1);
      }
    for (size_t s = 0; s < sections_.size(); ++s) carveSection(sections_[s], s == 0);
  }

  void carveSection(const Rect& r, bool has_office) {
    const int length = site_.cells(850), depth = site_.cells(420), w = site_.wall;
    if (!has_office || r.width() < 3 * length || r.height() < 3 * depth)
      return site_.carveRoom(r, Use::kCorridor, Side::kNorth);
    site_.canvas.carve({r.x0, r.y0, r.x1, r.y1 - depth - w});
    site_.canvas.carve({r.x0 + length + w, r.y0, r.x1, r.y1});
    site_.addRoom(r, Use::kCorridor, Side::kNorth);
    const int cut = r.x0 + site_.cells(450);
    const Rect office{r.x0, r.y1 - depth, cut, r.y1}, lounge{cut + w, r.y1 - depth, r.x0 + length, r.y1};
    site_.carveRoom(office, Use::kOffice, Side::kSouth);
    site_.addDoor(office, Side::kSouth, office.x0, office.x1);
    site_.carveRoom(lounge, Use::kLounge, Side::kSouth);
    site_.addDoor(lounge, Side::kSouth, lounge.x0, lounge.x1);
  }

  void addGates(const Rect& section, Side side, int low, int high) {
    const int gate = std::min(site_.cells(380), (high - low) / 3),
              count = std::max(1, (high - low) / site_.cells(3200));
    for (int i = 0; i < count; ++i) {
      const int from = low + (high - low) * i / count, to = low + (high - low) * (i + 1) / count;
      const int slack = (to - from - gate) / 4;
      const int at = (from + to - gate) / 2 + pick(site_.doors, -slack, slack);
      site_.canvas.carveDoor(site_.doorway(section, side, at, gate));
    }
  }

  void furnishSection(const Rect& r, size_t index) {
    core::RandomStream random(site_.seed, "building furniture section " + std::to_string(index));
    const auto chance = index == 0 ? 0 : random.below(100);
    if (site_.pillars > 0)
      raisePillars(r);
    else if (chance < 60)
      furnishRacks(random, r);
    else if (chance < 80)
      furnishBlocks(random, r);
    else
      furnishWorkshop(random, r);
    const int pieces = static_cast<int>(static_cast<std::int64_t>(r.width()) * r.height() /
                                        site_.cells(1000) / site_.cells(site_.pillars > 0 ? 8000 : 800));
    for (int i = 0; i < pieces; ++i) {
      const bool is_there = random.chance(site_.options.clutter), is_cart = random.below(3) == 0;
      if (is_there)
        site_.canvas.placeInside(random, r, site_.cells(120), site_.cells(80),
                                 is_cart ? Shape::kLegs : Shape::kSolid);
    }
    for (int i = (r.width() + r.height()) / site_.cells(1200); i > 0; --i)
      if (random.chance(site_.options.clutter)) {
        const int length = site_.cells(20 * pick(random, 8, 18));
        site_.canvas.placeAlong(random, r, pickSide(random), length, site_.cells(60));
      }
  }

  /// Double racks with aisles, cross aisles, a free strip before the gates in the south, pillars in the
  /// racks.
  void furnishRacks(core::RandomStream& random, const Rect& r) {
    const int depth = site_.cells(220), aisle = site_.corridor,
              staging = std::min(site_.cells(900), r.height() / 4);
    const Rect field{r.x0 + aisle, r.y0 + staging, r.x1 - aisle,
                     r.y1 - aisle - (r.height() > site_.cells(2000) ? site_.cells(500) : 0)};
    const bool lies = random.below(2) == 0;
    const int across = lies ? field.height() : field.width(), along = lies ? field.width() : field.height();
    const int least = site_.cells(540);
    if (along < least || across < depth) return furnishBlocks(random, r);
    const auto parts = partition(random, along, least, site_.cells(2700), aisle);
    const int count = (across + aisle) / (depth + aisle), spare = across - count * (depth + aisle) + aisle;
    for (int k = 0; k < count; ++k) {
      const int at = spare / 2 + k * (depth + aisle);
      for (const auto& [begin, end] : parts) {
        const Rect rack = lies ? Rect{field.x0 + begin, field.y0 + at, field.x0 + end, field.y0 + at + depth}
                               : Rect{field.x0 + at, field.y0 + begin, field.x0 + at + depth, field.y0 + end};
        if (site_.canvas.leavesWaysOpen(rack)) drawRack(random, rack);
      }
    }
    raisePillars({r.x0, r.y0, r.x1, field.y0});
  }

  /// Bays between pairs of posts: full ones are solid, under empty ones one sees and drives through.
  void drawRack(core::RandomStream& random, const Rect& rack) {
    const bool lies = rack.width() > rack.height();
    const int length = lies ? rack.width() : rack.height(), depth = lies ? rack.height() : rack.width();
    const int post = site_.cells(10), bays = std::max(1, length / site_.cells(270));
    const auto fill = [&](int u0, int v0, int u1, int v1) {
      site_.canvas.fill(lies ? Rect{rack.x0 + u0, rack.y0 + v0, rack.x0 + u1, rack.y0 + v1}
                             : Rect{rack.x0 + v0, rack.y0 + u0, rack.x0 + v1, rack.y0 + u1});
    };
    for (int bay = 0; bay <= bays; ++bay) {
      const int at = std::min(length - post, length * bay / bays);
      for (const int v : {0, depth / 2 - post / 2, depth - post}) fill(at, v, at + post, v + post);
      const bool is_full = random.chance(site_.options.clutter);
      if (bay < bays && is_full) fill(at, 0, length * (bay + 1) / bays, depth);
    }
  }

  void raisePillars(const Rect& r) {
    const int side = site_.cells(45), bay = site_.pillars > 0 ? site_.pillars : site_.cells(1050);
    const int nx = std::max(1, r.width() / bay), ny = std::max(1, r.height() / bay);
    for (int i = 1; i <= nx; ++i)
      for (int k = 1; k <= ny; ++k) {
        const int x = r.x0 + r.width() * i / (nx + 1) - side / 2,
                  y = r.y0 + r.height() * k / (ny + 1) - side / 2;
        site_.canvas.place({x, y, x + side, y + side});
      }
  }

  /// Pallets in blocks, side by side and behind one another.
  void furnishBlocks(core::RandomStream& random, const Rect& r) {
    raisePillars(r);
    const int length = site_.cells(130), depth = site_.cells(90), lane = site_.corridor;
    const int most_x = 6 * length + lane, most_y = 5 * depth + lane;
    for (int y = r.y0 + lane; y + most_y <= r.y1; y += most_y)
      for (int x = r.x0 + lane; x + most_x <= r.x1; x += most_x) {
        const int nx = pick(random, 2, 6), ny = pick(random, 2, 5);
        const Rect block{x, y, x + nx * length, y + ny * depth};
        if (!random.chance(site_.options.clutter) || !site_.canvas.leavesWaysOpen(block)) continue;
        for (int i = 0; i < nx; ++i)
          for (int k = 0; k < ny; ++k) {
            const int x0 = x + i * length, y0 = y + k * depth;
            if (k + 1 < ny || random.below(4) != 0)
              site_.canvas.fill({x0, y0, x0 + site_.cells(120), y0 + site_.cells(80)});
          }
      }
  }

  /// Machines in rows, all the same way round, each with a bench at its side; pillars between the rows.
  void furnishWorkshop(core::RandomStream& random, const Rect& r) {
    const bool lies = random.below(2) == 0;
    const int bay_along = site_.cells(700), bay_across = site_.cells(520), lane = site_.corridor;
    const int along = (lies ? r.width() : r.height()) - 2 * lane,
              across = (lies ? r.height() : r.width()) - 2 * lane;
    const int nu = std::max(1, along / bay_along), nv = std::max(1, across / bay_across);
    const auto place = [&](int u, int v, int length, int depth) {
      const Rect piece = lies ? Rect{r.x0 + u, r.y0 + v, r.x0 + u + length, r.y0 + v + depth}
                              : Rect{r.x0 + v, r.y0 + u, r.x0 + v + depth, r.y0 + u + length};
      site_.canvas.place(piece);
    };
    for (int k = 0; k < nv; ++k) {
      const int usual_depth = 20 * pick(random, 6, 11);  // a row holds machines of one make
      for (int i = 0; i < nu; ++i) {
        const int length = site_.cells(20 * pick(random, 12, 24)), depth = site_.cells(usual_depth);
        const bool is_there = random.chance(site_.options.clutter);
        const int u = lane + along * i / nu, v = lane + across * k / nv;
        if (is_there) place(u, v, length, depth);
        if (is_there && random.below(2) == 0)
          place(u, v + depth + site_.canvas.scale().passage + 1, site_.cells(160), site_.cells(70));
      }
    }
    raisePillars(r);
  }

  /// The gates of the outer wall in the south, shut: shallow niches.
  void hollowGates() {
    const int depth = std::min(site_.cells(15), site_.outer_wall - 2), gate = site_.cells(350);
    for (const Rect& r : sections_)
      for (int x = r.x0 + gate / 2; depth > 0 && r.y0 == 0 && x + gate <= r.x1; x += 2 * gate)
        site_.canvas.recess(r, Side::kSouth, x - r.x0, gate, depth);
  }

  Site& site_;
  std::vector<Rect> sections_;
};

}  // namespace

void drawHall(Site& site) {
  Hall(site).draw();
}

}  // namespace slam::buildings
