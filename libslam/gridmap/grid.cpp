#include "libslam/gridmap/grid.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/gridmap/crossed_cells.h"

namespace slam::gridmap {
namespace {

int logOdds(double probability) {
  return static_cast<int>(std::lround(SeenCell::kLogOddsPerNat * core::log(probability / (1 - probability))));
}

void require(bool condition, const char* what) {
  if (!condition) throw core::ContractError(std::string("gridmap::Grid: ") + what);
}

std::int16_t toShift(double cells) {
  return static_cast<std::int16_t>(std::lround(cells * FieldCell::kShiftsPerCell));
}

/// Of the same cell: whether the offset a is nearer than b, or equally near and first in order.
bool nearer(int ax, int ay, int bx, int by) {
  const int a = ax * ax + ay * ay, b = bx * bx + by * by;
  return a != b ? a < b : std::tie(ay, ax) < std::tie(by, bx);
}

int cellOf(double cells) {
  return static_cast<int>(std::floor(cells));
}

constexpr int kShiftUnit = static_cast<int>(FieldCell::kShiftsPerCell);

std::array<core::Point2, kSides + 1> sideDirections() {
  std::array<core::Point2, kSides + 1> directions{};
  for (unsigned i = 1; i <= kSides; ++i) {
    const double angle_rad = 2 * core::kPi * (i - 1) / kSides;
    directions[i] = {core::cos(angle_rad), core::sin(angle_rad)};
  }
  return directions;
}

}  // namespace

const std::array<core::Point2, kSides + 1> kSideDirections = sideDirections();

Side sideTowards(const core::Point2& direction) {
  Side nearest = kNoSide;
  for (Side side = 1; side <= kSides; ++side)
    if (cosine(side, direction.x, direction.y) > cosine(nearest, direction.x, direction.y)) nearest = side;
  return nearest;
}

Grid::Grid(const GridOptions& options) : options_(options) {
  require(options.cell_m > 0 && std::isfinite(options.cell_m), "cell_m must be positive");
  require(options.min_probability > 0 && options.min_probability < 0.5 && options.max_probability > 0.5 &&
              options.max_probability <= 0.99,
          "min_probability < 0.5 < max_probability <= 0.99");
  require(options.hit_probability > 0.5 && options.hit_probability <= options.max_probability,
          "hit_probability must be above 0.5 and at most max_probability");
  require(options.pass_probability < 0.5 && options.pass_probability >= options.min_probability,
          "pass_probability must be below 0.5 and at least min_probability");
  require(options.reach_cells >= 1 && options.reach_cells <= 16, "reach_cells must be 1 to 16");
  hit_ = std::max(1, logOdds(options.hit_probability));
  pass_ = std::max(1, -logOdds(options.pass_probability));
  most_ = logOdds(options.max_probability);
  least_ = std::max(-127, logOdds(options.min_probability));
  const int reach = options.reach_cells;
  auto disc = std::make_shared<std::vector<Offset>>();
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x) {
      if (x * x + y * y > reach * reach) continue;
      disc->push_back({static_cast<std::int8_t>(x), static_cast<std::int8_t>(y)});
      int& half_width = half_width_[static_cast<size_t>(std::abs(y))];
      half_width = std::max(half_width, x);
    }
  std::sort(disc->begin(), disc->end(),
            [](const Offset& a, const Offset& b) { return nearer(a.x, a.y, b.x, b.y); });
  disc_ = std::move(disc);
}

void Grid::coverTiles(int x_min, int y_min, int x_max, int y_max) {
  int tx0 = x_min >> kTileBits, ty0 = y_min >> kTileBits, tx1 = x_max >> kTileBits, ty1 = y_max >> kTileBits;
  const bool empty = tiles_.empty();
  if (!empty && tx0 >= tile_x_min_ && ty0 >= tile_y_min_ && tx1 < tile_x_min_ + tile_columns_ &&
      ty1 < tile_y_min_ + tile_rows_)
    return;
  if (!empty) {
    tx0 = std::min(tx0, tile_x_min_), ty0 = std::min(ty0, tile_y_min_);
    tx1 = std::max(tx1, tile_x_min_ + tile_columns_ - 1), ty1 = std::max(ty1, tile_y_min_ + tile_rows_ - 1);
  }
  const int columns = tx1 - tx0 + 1, rows = ty1 - ty0 + 1;
  std::vector<Tile> tiles(static_cast<size_t>(columns) * static_cast<size_t>(rows));
  for (int row = 0; row < tile_rows_; ++row)
    for (int column = 0; column < tile_columns_; ++column)
      tiles[static_cast<size_t>(row + tile_y_min_ - ty0) * static_cast<size_t>(columns) +
            static_cast<size_t>(column + tile_x_min_ - tx0)] =
          std::move(tiles_[static_cast<size_t>(row) * static_cast<size_t>(tile_columns_) +
                           static_cast<size_t>(column)]);
  tiles_ = std::move(tiles);
  tile_x_min_ = tx0, tile_y_min_ = ty0, tile_columns_ = columns, tile_rows_ = rows;
}

SeenCell& Grid::ownSeen(int x, int y) {
  return tileFor(x >> kTileBits, y >> kTileBits).seen.own()[indexInTile(x, y)];
}

FieldCell& Grid::ownField(int x, int y) {
  return tileFor(x >> kTileBits, y >> kTileBits).field.own()[indexInTile(x, y)];
}

std::optional<Cell> Grid::at(int x, int y) const {
  const SeenCell* seen = seenAt(x, y);
  const FieldCell* field = fieldAt(x, y);
  if (!seen && !field) return std::nullopt;
  return Cell{seen ? *seen : SeenCell{}, field ? *field : FieldCell{}};
}

/// Calls change(cell, offset to the centre) for the cells of the disc; change returns what the cell becomes,
/// and only cells that differ are written.
template <class Change>
void Grid::forDisc(const Spot& centre, const Change& change) {
  const int reach = options_.reach_cells;
  for (int tile_y = (centre.y - reach) >> kTileBits; tile_y <= (centre.y + reach) >> kTileBits; ++tile_y)
    for (int tile_x = (centre.x - reach) >> kTileBits; tile_x <= (centre.x + reach) >> kTileBits; ++tile_x) {
      Tile& tile = tileFor(tile_x, tile_y);
      FieldLayer* own = nullptr;
      const FieldLayer* layer = tile.field ? &*tile.field : nullptr;
      const int x_begin = tile_x * kTileSide, y_begin = tile_y * kTileSide;
      const int y_first = std::max(centre.y - reach, y_begin);
      const int y_last = std::min(centre.y + reach, y_begin + kTileMask);
      for (int y = y_first; y <= y_last; ++y) {
        const int half_width = half_width_[static_cast<size_t>(std::abs(y - centre.y))];
        const int x_first = std::max(centre.x - half_width, x_begin);
        const int x_last = std::min(centre.x + half_width, x_begin + kTileMask);
        for (int x = x_first; x <= x_last; ++x) {
          const size_t index = indexInTile(x, y);
          FieldCell cell = layer ? (*layer)[index] : FieldCell{};
          if (!change(cell, centre.x - x, centre.y - y)) continue;
          if (!own) layer = own = &tile.field.own();
          (*own)[index] = cell;
        }
      }
    }
}

/// Tells the cells around an occupied one where its surface is.
void Grid::spreadFrom(const Spot& surface) {
  const FieldCell source = *fieldAt(surface.x, surface.y);
  forDisc(surface, [&source](FieldCell& cell, int dx, int dy) {
    if (cell.nearSurface() && (cell.toX() != dx || cell.toY() != dy) &&
        !nearer(dx, dy, cell.toX(), cell.toY()))
      return false;
    cell.setNearest(dx, dy, source.side());
    cell.shift_x = static_cast<std::int16_t>(source.shift_x + dx * kShiftUnit);
    cell.shift_y = static_cast<std::int16_t>(source.shift_y + dy * kShiftUnit);
    return true;
  });
}

/// Cuts the cells around a surface that is gone loose from it.
void Grid::forget(const Spot& surface, std::vector<Spot>& orphans) {
  forDisc(surface, [&](FieldCell& cell, int dx, int dy) {
    if (!cell.nearSurface() || cell.toX() != dx || cell.toY() != dy) return false;
    orphans.push_back({surface.x - dx, surface.y - dy});
    cell = {};
    return true;
  });
}

void Grid::findNearest(const Spot& spot) {
  for (const Offset& offset : *disc_) {
    const SeenCell* other = seenAt(spot.x + offset.x, spot.y + offset.y);
    if (!other || !other->occupied()) continue;
    const FieldCell source = *fieldAt(spot.x + offset.x, spot.y + offset.y);
    FieldCell& cell = ownField(spot.x, spot.y);
    cell.setNearest(offset.x, offset.y, source.side());
    cell.shift_x = static_cast<std::int16_t>(source.shift_x + offset.x * kShiftUnit);
    cell.shift_y = static_cast<std::int16_t>(source.shift_y + offset.y * kShiftUnit);
    return;
  }
}

/// A scan's rays on the raster; in cells, from their shared origin.
struct Grid::Beams {
  core::Point2 origin;
  std::vector<core::Point2> ends;
  double sine, cosine;  ///< of the robot's heading
  double x_min, x_max, y_min, y_max;

  Beams(const ScanRays& rays, const core::Pose2& T_map_robot, double cell_m) {
    const auto [s, c] = core::sinCos(T_map_robot.phi);
    sine = s, cosine = c;
    const double per_cell = 1 / cell_m;
    const auto toCells = [&](const core::Point2& p) {
      return core::Point2{(T_map_robot.x + cosine * p.x - sine * p.y) * per_cell,
                          (T_map_robot.y + sine * p.x + cosine * p.y) * per_cell};
    };
    origin = toCells(rays.origin);
    ends.reserve(rays.rays.size());
    x_min = x_max = origin.x, y_min = y_max = origin.y;
    for (const Ray& ray : rays.rays) {
      const core::Point2 end = toCells(ray.end);
      x_min = std::min(x_min, end.x), x_max = std::max(x_max, end.x);
      y_min = std::min(y_min, end.y), y_max = std::max(y_max, end.y);
      ends.push_back(end);
    }
  }
};

/// Lowers what the rays cross, and says which surfaces that ends. Cells that are certain already stay shared.
std::vector<Grid::Spot> Grid::pass(const CrossedCells& crossed, const CrossedCells& hit) {
  std::vector<Spot> gone;
  for (int tile_y = crossed.tileRowMin(); tile_y <= crossed.tileRowMax(); ++tile_y)
    for (int tile_x = crossed.tileColumnMin(); tile_x <= crossed.tileColumnMax(); ++tile_x) {
      Tile& tile = tileFor(tile_x, tile_y);
      SeenLayer* own = nullptr;
      const SeenLayer* layer = tile.seen ? &*tile.seen : nullptr;
      for (int row = 0; row < kTileSide; ++row) {
        const int y = tile_y * kTileSide + row;
        for (std::uint32_t bits = crossed.word(tile_x, y) & ~hit.word(tile_x, y); bits; bits &= bits - 1) {
          const int column = __builtin_ctz(bits);
          const auto index = static_cast<size_t>((row << kTileBits) | column);
          const SeenCell cell = layer ? (*layer)[index] : SeenCell{};
          const int before = cell.seen() ? cell.log_odds : 0;
          const int after = std::max(least_, before - pass_);
          if (cell.seen() && after == before) continue;
          if (!own) layer = own = &tile.seen.own();
          (*own)[index].log_odds = static_cast<std::int8_t>(after);
          if (before > 0 && after <= 0) gone.push_back({tile_x * kTileSide + column, y});
        }
      }
    }
  return gone;
}

/// A ray's return into its cell, from a surface with this normal. is_first: of this scan; only then the
/// log-odds rise, whereas every return counts for the place of the surface that lies there, if it is seen
/// from the same side. Whether that moved.
bool Grid::addReturn(const Spot& spot, const core::Point2& end, const core::Point2& normal, bool is_first) {
  const Cell before = at(spot.x, spot.y).value_or(Cell{});
  Cell after = before;
  if (is_first)
    after.log_odds = static_cast<std::int8_t>(
        std::min(most_, (before.seen() ? static_cast<int>(before.log_odds) : 0) + hit_));
  const bool is_other = before.occupied() && cosine(before.side(), normal.x, normal.y) <
                                                 kOtherSide * core::hypot(normal.x, normal.y);
  const bool moves = after.occupied() && before.returns < SeenCell::kMostReturns && !is_other;
  if (moves) {
    const double x = end.x - (spot.x + 0.5), y = end.y - (spot.y + 0.5);
    if (!before.occupied()) after.shift_x = after.shift_y = 0, after.returns = 0;
    ++after.returns;
    after.shift_x = static_cast<std::int16_t>(
        after.shift_x + toShift((x - after.shift_x / FieldCell::kShiftsPerCell) / after.returns));
    after.shift_y = static_cast<std::int16_t>(
        after.shift_y + toShift((y - after.shift_y / FieldCell::kShiftsPerCell) / after.returns));
    after.setNearest(0, 0, before.occupied() ? before.side() : sideTowards(normal));
  }
  if (after.log_odds != before.log_odds || after.returns != before.returns) ownSeen(spot.x, spot.y) = after;
  if (moves) ownField(spot.x, spot.y) = after;
  return moves;
}

/// The returns of a scan; the cells whose surface moved, each once.
std::vector<Grid::Spot> Grid::addReturns(const ScanRays& rays, const Beams& beams, CrossedCells& hit) {
  std::vector<Spot> moved;
  for (size_t i = 0; i < beams.ends.size(); ++i) {
    if (!rays.rays[i].hit) continue;
    const Spot spot{cellOf(beams.ends[i].x), cellOf(beams.ends[i].y)};
    const core::Point2& n = rays.rays[i].normal;
    const core::Point2 normal{beams.cosine * n.x - beams.sine * n.y, beams.sine * n.x + beams.cosine * n.y};
    if (addReturn(spot, beams.ends[i], normal, hit.take(spot.x, spot.y))) moved.push_back(spot);
  }
  std::sort(moved.begin(), moved.end(),
            [](const Spot& a, const Spot& b) { return std::tie(a.y, a.x) < std::tie(b.y, b.x); });
  moved.erase(std::unique(moved.begin(), moved.end(),
                          [](const Spot& a, const Spot& b) { return a.x == b.x && a.y == b.y; }),
              moved.end());
  return moved;
}

void Grid::insert(const ScanRays& rays, const core::Pose2& T_map_robot) {
  require(core::isFinite(T_map_robot), "the pose is not finite");
  if (rays.rays.empty()) return;
  const Beams beams(rays, T_map_robot, options_.cell_m);
  constexpr double kFarthest = 1 << 30;
  require(beams.x_min > -kFarthest && beams.y_min > -kFarthest && beams.x_max < kFarthest &&
              beams.y_max < kFarthest,
          "beyond 2^30 cells from the origin");
  const int x_min = cellOf(beams.x_min), y_min = cellOf(beams.y_min), x_max = cellOf(beams.x_max),
            y_max = cellOf(beams.y_max);
  CrossedCells crossed(x_min, y_min, x_max, y_max), hit(x_min, y_min, x_max, y_max);
  for (size_t i = 0; i < beams.ends.size(); ++i) {
    crossed.addLine(beams.origin, beams.ends[i]);
    if (rays.rays[i].hit) hit.add(cellOf(beams.ends[i].x), cellOf(beams.ends[i].y));
  }
  const int reach = options_.reach_cells;
  coverTiles(x_min - reach, y_min - reach, x_max + reach, y_max + reach);

  std::vector<Spot> orphans;
  for (const Spot& spot : pass(crossed, hit)) {
    forget(spot, orphans);
    ownSeen(spot.x, spot.y).returns = 0;
  }
  for (const Spot& spot : addReturns(rays, beams, hit)) spreadFrom(spot);
  for (const Spot& spot : orphans) findNearest(spot);
}

double Grid::probability(int x, int y) const {
  const SeenCell* cell = seenAt(x, y);
  if (!cell || !cell->seen()) return 0.5;
  return 1 / (1 + core::exp(-cell->log_odds / SeenCell::kLogOddsPerNat));
}

size_t Grid::tiles() const {
  return static_cast<size_t>(
      std::count_if(tiles_.begin(), tiles_.end(), [](const Tile& tile) { return !tile.empty(); }));
}

size_t Grid::ownTiles() const {
  return static_cast<size_t>(std::count_if(tiles_.begin(), tiles_.end(), [](const Tile& tile) {
    return tile.seen.isOwn() || tile.field.isOwn();
  }));
}

GridArea Grid::area() const {
  const double tile_m = kTileSide * options_.cell_m;
  return {tile_x_min_ * tile_m, (tile_x_min_ + tile_columns_) * tile_m, tile_y_min_ * tile_m,
          (tile_y_min_ + tile_rows_) * tile_m};
}

void Grid::appendParts(std::vector<std::pair<const void*, size_t>>& parts) const {
  for (const Tile& tile : tiles_) {
    if (tile.seen) parts.emplace_back(tile.seen.identity(), sizeof(SeenLayer));
    if (tile.field) parts.emplace_back(tile.field.identity(), sizeof(FieldLayer));
  }
}

OccupancyRaster Grid::toRaster() const {
  int x_min = INT32_MAX, x_max = INT32_MIN, y_min = INT32_MAX, y_max = INT32_MIN;
  for (int row = 0; row < tile_rows_; ++row)
    for (int column = 0; column < tile_columns_; ++column) {
      const Tile* tile = tileAt(tile_x_min_ + column, tile_y_min_ + row);
      if (!tile->seen) continue;
      for (int i = 0; i < kTileSide * kTileSide; ++i) {
        if (!(*tile->seen)[static_cast<size_t>(i)].seen()) continue;
        const int x = (tile_x_min_ + column) * kTileSide + (i & kTileMask);
        const int y = (tile_y_min_ + row) * kTileSide + (i >> kTileBits);
        x_min = std::min(x_min, x), x_max = std::max(x_max, x);
        y_min = std::min(y_min, y), y_max = std::max(y_max, y);
      }
    }
  if (x_min > x_max) x_min = x_max = y_min = y_max = 0;
  OccupancyRaster raster;
  raster.resolution_m = options_.cell_m;
  raster.columns = x_max - x_min + 1, raster.rows = y_max - y_min + 1;
  raster.x_min_m = x_min * options_.cell_m, raster.y_min_m = y_min * options_.cell_m;
  raster.occupancy.reserve(static_cast<size_t>(raster.columns) * static_cast<size_t>(raster.rows));
  for (int y = y_min; y <= y_max; ++y)
    for (int x = x_min; x <= x_max; ++x) raster.occupancy.push_back(static_cast<float>(probability(x, y)));
  return raster;
}

Grid Grid::fromRaster(const OccupancyRaster& raster, const GridOptions& options) {
  Grid grid(options);
  require(std::abs(raster.resolution_m - options.cell_m) <= 1e-6, "the raster has another resolution");
  if (raster.columns <= 0 || raster.rows <= 0) return grid;
  const int x_min = static_cast<int>(std::lround(raster.x_min_m / options.cell_m));
  const int y_min = static_cast<int>(std::lround(raster.y_min_m / options.cell_m));
  const int reach = options.reach_cells;
  grid.coverTiles(x_min - reach, y_min - reach, x_min + raster.columns - 1 + reach,
                  y_min + raster.rows - 1 + reach);
  std::vector<Spot> surfaces;
  for (int row = 0; row < raster.rows; ++row)
    for (int column = 0; column < raster.columns; ++column) {
      const float occupancy = raster.at(column, row);
      if (occupancy == 0.5F) continue;
      const double bounded = std::clamp(static_cast<double>(occupancy), 1e-3, 1 - 1e-3);
      SeenCell& cell = grid.ownSeen(x_min + column, y_min + row);
      cell.log_odds = static_cast<std::int8_t>(std::clamp(logOdds(bounded), grid.least_, grid.most_));
      if (!cell.occupied()) continue;
      cell.returns = 1;
      grid.ownField(x_min + column, y_min + row).setNearest(0, 0, kNoSide);
      surfaces.push_back({x_min + column, y_min + row});
    }
  for (const Spot& surface : surfaces) grid.spreadFrom(surface);
  return grid;
}

}  // namespace slam::gridmap
