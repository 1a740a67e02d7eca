#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "libslam/buildings/generator/site.h"
#include "libslam/world/region.h"

namespace slam::buildings {
namespace {

/// Value noise (Perlin's lattice without gradients; Ebert et al., Texturing and Modeling, 3rd ed., 2002, ch.
/// 2) in whole numbers: random values at lattice points `period` cells apart, between them blended smoothly.
class Noise {
 public:
  Noise(core::RandomStream& random, int width, int height, int period)
      : period_(std::max(2, period)), columns_(width / period_ + 2) {
    const int rows = height / period_ + 2;
    for (int i = 0; i < columns_ * rows; ++i) values_.push_back(pick(random, -kOne, kOne));
    for (std::int64_t t = 0, p = period_; t < p; ++t)  // 3 t^2 - 2 t^3
      blend_.push_back(static_cast<int>(kOne * (3 * t * t * p - 2 * t * t * t) / (p * p * p)));
  }

  static constexpr int kOne = 1024;
  /// Adds weight * noise, noise from -kOne to kOne, to a row of cells.
  void addRow(int y, int weight, std::vector<int>& row) const {
    const int by = blend_[static_cast<size_t>(y % period_)];
    const int* below = values_.data() + static_cast<std::ptrdiff_t>(y / period_) * columns_;
    const auto at = [&](int i) { return below[i] + (below[i + columns_] - below[i]) * by / kOne; };
    const int width = static_cast<int>(row.size());
    for (int i = 0, x = 0; x < width; ++i) {
      const int left = at(i), rise = at(i + 1) - left, end = std::min(width, x + period_);
      for (const int* blend = blend_.data(); x < end; ++x, ++blend)
        row[static_cast<size_t>(x)] += weight * (left + rise * *blend / kOne);
    }
  }

 private:
  int period_, columns_;
  std::vector<int> values_, blend_;
};

struct Chamber {
  int x, y, radius;
};

class Cave {
 public:
  explicit Cave(Site& site)
      : site_(site),
        random_(site.layout),
        width_(site.width),
        height_(site.height),
        field_(static_cast<size_t>(std::max(0, width_)) * std::max(0, height_)) {}

  void draw() {
    layChambers();
    fillField();
    for (const Chamber& chamber : chambers_) hollow(chamber);
    digTunnels();
    carve();
    site_.canvas.raiseWalls(site_.outer_wall);
    strewBoulders();
  }

 private:
  /// One to a square of the usual distance, off its middle, so large that rock remains at the rim.
  void layChambers() {
    // Closer in a small cave, which would else be a single bubble.
    const int usual = std::min(site_.room, std::max(site_.cells(350), height_ * 2 / 3));
    const int nx = std::max(1, (width_ + usual / 2) / usual), ny = std::max(1, (height_ + usual / 2) / usual);
    columns_ = nx;
    for (int k = 0; k < ny; ++k)
      for (int i = 0; i < nx; ++i) {
        const int sx = width_ / nx, sy = height_ / ny;
        // Far enough from the rim for the place in its middle that is open for sure.
        const int rim = std::min(site_.cells(140), height_ / 2);
        const int x = std::clamp(sx / 2 + sx * i + pick(random_, -sx / 4, sx / 4), rim, width_ - rim);
        const int y = std::clamp(sy / 2 + sy * k + pick(random_, -sy / 4, sy / 4), rim, height_ - rim);
        const int most = std::min({x, y, width_ - x, height_ - y}) * 3 / 4;
        const int radius = std::min(most, std::min(sx, sy) * pick(random_, 28, 46) / 100);
        chambers_.push_back({x, y, radius});
        site_.addRoom({x - radius / 2, y - radius / 2, x + radius / 2, y + radius / 2}, Use::kCorridor,
                      Side::kSouth);
      }
  }

  /// Open where positive: noise of several sizes, rock at the rim.
  void fillField() {
    const Noise large(random_, width_, height_, site_.cells(620)),
        middle(random_, width_, height_, site_.cells(290)), small(random_, width_, height_, site_.cells(130)),
        fine(random_, width_, height_, site_.cells(55)), finest(random_, width_, height_, site_.cells(22));
    const int rim = std::min(site_.cells(320), std::min(width_, height_) / 7);
    std::vector<int> noise(static_cast<size_t>(width_)), wave(noise.size());
    for (int y = 0; y < height_; ++y) {
      std::fill(noise.begin(), noise.end(), 0);
      large.addRow(y, 8, noise), middle.addRow(y, 5, noise);
      wave = noise;
      small.addRow(y, 3, noise), fine.addRow(y, 2, noise), finest.addRow(y, 1, noise);
      for (int x = 0; x < width_; ++x) {
        const int from_rim = std::min(std::min(x, y), std::min(width_ - 1 - x, height_ - 1 - y));
        const int wavy_rim = rim + static_cast<int>(std::int64_t{rim} * wave[static_cast<size_t>(x)] /
                                                    (std::int64_t{16} * Noise::kOne));
        const std::int64_t near = std::max(0, wavy_rim - from_rim);
        const std::int64_t rock = kRock + 3000 * near * near / (std::int64_t{rim} * rim);
        field(x, y) = static_cast<std::int16_t>(
            std::max<std::int64_t>(-30000, noise[static_cast<size_t>(x)] / 8 - rock));
      }
    }
  }

  /// Raises the field towards a chamber's middle.
  void hollow(const Chamber& c) {
    const std::int64_t sure = std::max(site_.cells(75), c.radius * 6 / 10),
                       reach = std::max<std::int64_t>(sure, c.radius + c.radius / 2);
    const std::int64_t r2 = static_cast<std::int64_t>(c.radius) * c.radius;
    for (auto y = std::max<std::int64_t>(0, c.y - reach); y < std::min<std::int64_t>(height_, c.y + reach);
         ++y)
      for (auto x = std::max<std::int64_t>(0, c.x - reach); x < std::min<std::int64_t>(width_, c.x + reach);
           ++x) {
        const std::int64_t d2 = (x - c.x) * (x - c.x) + (y - c.y) * (y - c.y);
        const std::int64_t raise = kRock + 1500 * (r2 - d2) / std::max<std::int64_t>(1, r2);
        auto& here = field(static_cast<int>(x), static_cast<int>(y));
        if (d2 <= sure * sure)
          here = 4000;
        else if (raise > 0)
          here = static_cast<std::int16_t>(std::min<std::int64_t>(4000, here + raise));
      }
  }

  /// A tree that joins all chambers, and a third of the other neighbours for loops.
  void digTunnels() {
    std::vector<std::pair<int, int>> pairs;
    const int count = static_cast<int>(chambers_.size());
    for (int i = 0; i < count; ++i) {
      if ((i + 1) % columns_ != 0) pairs.emplace_back(i, i + 1);
      if (i + columns_ < count) pairs.emplace_back(i, i + columns_);
    }
    for (size_t i = pairs.size(); i > 1; --i) std::swap(pairs[i - 1], pairs[random_.below(i)]);
    std::vector<int> tree(chambers_.size());
    std::iota(tree.begin(), tree.end(), 0);
    const auto rootOf = [&tree](int i) {
      while (tree[static_cast<size_t>(i)] != i) i = tree[static_cast<size_t>(i)];
      return i;
    };
    for (const auto& [a, b] : pairs) {
      const int root_a = rootOf(a), root_b = rootOf(b);
      if (root_a == root_b && random_.below(3) != 0) continue;
      tree[static_cast<size_t>(root_a)] = root_b;
      dig(chambers_[static_cast<size_t>(a)], chambers_[static_cast<size_t>(b)], 0);
    }
  }

  /// A way that bends by chance at every halving, in steps as long as it is wide.
  void dig(const Chamber& a, const Chamber& b, int depth) {
    const std::int64_t dx = b.x - a.x, dy = b.y - a.y, distance2 = dx * dx + dy * dy;
    const int step = site_.corridor / 6 + 1;
    if (distance2 <= static_cast<std::int64_t>(step) * step) return;
    const int bend = depth < 5 ? pick(random_, -25, 25) : 0;
    const int margin = site_.corridor;
    Chamber middle{static_cast<int>((a.x + b.x) / 2 - dy * bend / 100),
                   static_cast<int>((a.y + b.y) / 2 + dx * bend / 100), 0};
    // Away from the rim, but never further from an end than the ends are apart: the halves must get shorter.
    const auto clampBetween = [margin](int at, int end_a, int end_b, int side) {
      const int low = std::min({margin, end_a, end_b}), high = std::max({side - margin, end_a, end_b});
      return std::clamp(at, low, high);
    };
    middle.x = clampBetween(middle.x, a.x, b.x, width_), middle.y = clampBetween(middle.y, a.y, b.y, height_);
    widen(middle);
    dig(a, middle, depth + 1);
    dig(middle, b, depth + 1);
  }

  /// Open for sure as far as a robot needs, further out where the noise is in favour.
  void widen(const Chamber& at) {
    const int sure = std::max(site_.corridor * 3 / 8, site_.cells(50)),
              reach = std::max(sure, site_.corridor * 5 / 4);
    for (int y = std::max(0, at.y - reach); y < std::min(height_, at.y + reach + 1); ++y)
      for (int x = std::max(0, at.x - reach); x < std::min(width_, at.x + reach + 1); ++x) {
        const int d2 = (x - at.x) * (x - at.x) + (y - at.y) * (y - at.y);
        auto& here = field(x, y);
        if (d2 <= sure * sure)
          here = 4000;
        else if (d2 <= reach * reach && here < 4000 && here > -kRock - 500 + 700 * d2 / (reach * reach))
          here = std::max<std::int16_t>(here, 1);
      }
  }

  /// What no robot reaches is rock before there are walls, and specks of rock are none.
  void carve() {
    world::Plan open;
    open.columns = width_, open.rows = height_;
    open.cells.assign(field_.size(), world::Cell::kOccupied);
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x)
        if (isOpen(x, y)) open.cells[static_cast<size_t>(y) * width_ + x] = world::Cell::kFree;
    clearSpecks(open);
    fillPockets(open, kRobotRadius_m / site_.options.resolution_m);
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) {
        const int begin = x;
        while (x < width_ && open.at(x, y) == world::Cell::kFree) ++x;
        if (x > begin) site_.canvas.carve({begin, y, x, y + 1});
      }
  }

  void clearSpecks(world::Plan& open) const {
    std::vector<char> is_rock(open.cells.size());
    for (size_t i = 0; i < is_rock.size(); ++i) is_rock[i] = open.cells[i] == world::Cell::kOccupied;
    const std::vector<world::RegionRun> runs = world::regionRuns(width_, is_rock);
    std::vector<size_t> cells(runs.size(), 0);
    for (const world::RegionRun& run : runs) cells[run.region] += run.end - run.begin;
    const auto least = static_cast<size_t>(site_.cells(50)) * site_.cells(50);
    for (const world::RegionRun& run : runs)
      if (cells[run.region] < least)
        for (size_t i = run.begin; i < run.end; ++i) open.cells[i] = world::Cell::kFree;
  }

  /// The majority around a cell decides, so that no single cell sticks out.
  bool isOpen(int x, int y) const {
    if (x < 1 || y < 1 || x + 1 >= width_ || y + 1 >= height_) return false;
    int open = 0;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) open += field(x + dx, y + dy) > 0;
    return open >= 5;
  }

  void strewBoulders() {
    core::RandomStream random(site_.seed, "building furniture boulders");
    for (const Room& room : site_.rooms)
      for (int i = pick(random, 0, 4); i > 0; --i) {
        const int size = site_.cells(10 * pick(random, 3, 9));
        if (random.chance(site_.options.clutter))
          site_.canvas.placeInside(random, room.rect, size, size, Shape::kDisc);
      }
  }

  std::int16_t& field(int x, int y) { return field_[static_cast<size_t>(y) * width_ + x]; }
  std::int16_t field(int x, int y) const { return field_[static_cast<size_t>(y) * width_ + x]; }

  static constexpr int kRock = 520;  // how far the noise must rise to be open
  Site& site_;
  core::RandomStream& random_;
  int width_, height_, columns_ = 1;
  std::vector<std::int16_t> field_;
  std::vector<Chamber> chambers_;
};

}  // namespace

void drawCave(Site& site) {
  site.requireInside("cave", site.cells(420), site.cells(420));
  Cave(site).draw();
}

}  // namespace slam::buildings
