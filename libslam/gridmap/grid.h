#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/gridmap/occupancy_raster.h"
#include "libslam/gridmap/scan_rays.h"
#include "libslam/threads/shared_part.h"

namespace slam::gridmap {

class CrossedCells;

struct GridOptions {
  double cell_m = 0.05;
  double hit_probability = 0.7;   ///< that a cell is occupied, from one scan with a return in it
  double pass_probability = 0.4;  ///< the same, from one scan of which a beam passed through
  double max_probability = 0.97;  ///< certainty is kept between these, so that a map can change its mind
  double min_probability = 0.12;
  int reach_cells = 8;  ///< the field knows surfaces up to this distance; 1 to 16
};

/// A direction of the map frame as a number of four bits: from which side a surface is seen. Nothing is known
/// of kNoSide.
using Side = std::uint8_t;
inline constexpr Side kNoSide = 0, kSides = 15;
/// The side in this direction; kNoSide for (0, 0).
Side sideTowards(const core::Point2& direction);
/// Unit vectors, of the sides' middles; (0, 0) of kNoSide.
extern const std::array<core::Point2, kSides + 1> kSideDirections;
/// Cosine between a side's middle and a unit vector; 0 of kNoSide.
inline double cosine(Side side, double x, double y) {
  return kSideDirections[side].x * x + kSideDirections[side].y * y;
}
/// A surface is seen from the other side below this cosine, and is another one: walls are thin.
inline constexpr double kOtherSide = -0.2;

/// What a Grid's field says in a cell, 6 bytes.
class FieldCell {
 public:
  static constexpr double kShiftsPerCell = 1024;  ///< unit of shift_x, shift_y

  bool nearSurface() const { return nearest_ != kNowhere; }
  /// From this cell to the nearest occupied one, in cells of -16 to 16. REQUIRES nearSurface().
  int toX() const { return (nearest_ & kMask) - kMost; }
  int toY() const { return (nearest_ >> kBits & kMask) - kMost; }
  /// From which that one is seen; kNoSide where that was not told.
  Side side() const { return static_cast<Side>(nearest_ >> 2 * kBits & 15U); }
  void setNearest(int to_x, int to_y, Side seen_from) {
    nearest_ = static_cast<std::uint16_t>((to_x + kMost) | (to_y + kMost) << kBits | seen_from << 2 * kBits);
  }

  /// From this cell's centre to the surface in the cell at (toX(), toY()): the mean of the first returns in
  /// it.
  std::int16_t shift_x = 0, shift_y = 0;

 private:
  static constexpr int kMost = 16, kBits = 6, kMask = (1 << kBits) - 1;
  static constexpr std::uint16_t kNowhere = 0xFFFF;
  std::uint16_t nearest_ = kNowhere;
};

/// How a Grid's cell was seen, 2 bytes.
struct SeenCell {
  static constexpr std::int8_t kUnseen = -128;  ///< log_odds where no beam was
  static constexpr double kLogOddsPerNat = 20;  ///< unit of log_odds
  static constexpr int kMostReturns = 16;

  std::int8_t log_odds = kUnseen;
  std::uint8_t returns = 0;  ///< in the mean of an occupied cell's returns, up to kMostReturns

  bool seen() const { return log_odds != kUnseen; }
  bool occupied() const { return log_odds > 0; }
};

/// One cell of a Grid.
struct Cell : SeenCell, FieldCell {};

/// A rectangle of the map frame.
struct GridArea {
  double x_min_m = 0, x_max_m = 0, y_min_m = 0, y_max_m = 0;
};

/// Occupancy and distance to the nearest surface, for matching scans to it in many versions at once.
///
/// Shape: cell (x, y) covers [x, x + 1) x [y, y + 1) in units of cell_m, map frame; any x and y. Cells live
/// in tiles of 32 x 32 that appear where something is stored, in two layers: what was seen, and the field.
/// Copies share the layers of their tiles, and a layer is copied when one of those that share it changes it
/// (copy on write): a copy costs two pointers per tile. Apart, because most scans change what is seen, and
/// few the field, which is three times as large.
///
/// Occupancy: log-odds in steps of 1/20. One scan changes a cell once at most: by a hit where it has a
/// return, else by a pass where a beam crossed it (Moravec and Elfes 1985; that a scan's hits win over its
/// passes keeps walls that are seen at a grazing angle). A cell is occupied above probability 0.5. Unseen
/// cells are kept apart from undecided ones.
///
/// Field: every cell within reach_cells of an occupied one (distance between cell centres) knows the nearest,
/// among equally near ones that with the least (to_y, to_x), and the vector from its centre to the surface
/// there. The vector is linear in position along and across a straight wall, so that it can be interpolated
/// between cell centres without the rounding to cells that a distance without a sign has. Insertion keeps the
/// field exact: it always equals one made anew from the occupied cells. With the surface goes the side that
/// its first return was seen from: returns from the other side of a thin wall, whose two faces may fall into
/// one cell, count for its occupancy, and not for the place of that surface.
///
/// Threads: different grids may be used by different threads, also when they share tiles. Same calls, same
/// bytes.
class Grid {
 public:
  /// REQUIRES options in their ranges (ContractError).
  explicit Grid(const GridOptions& options);

  /// Draws a scan seen from T_map_robot. Along each ray every cell that the line touches counts as crossed.
  /// REQUIRES a finite pose, and everything within 2^30 cells of the origin (ContractError).
  /// Cost: about 2 ns per crossed cell and 0.1 us per cell with a return.
  void insert(const ScanRays& rays, const core::Pose2& T_map_robot);

  double cellSize() const { return options_.cell_m; }
  const GridOptions& options() const { return options_; }
  /// Nothing where nothing was stored; then nothing was seen there and no surface is near.
  std::optional<Cell> at(int x, int y) const;
  /// The field in the four cells (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1); false when one of them lies
  /// where nothing is stored.
  bool square(int x, int y, std::array<const FieldCell*, 4>& cells) const {
    if ((x & kTileMask) != kTileMask && (y & kTileMask) != kTileMask) {
      cells[0] = fieldAt(x, y);
      if (!cells[0]) return false;
      cells[1] = cells[0] + 1, cells[2] = cells[0] + kTileSide, cells[3] = cells[0] + kTileSide + 1;
      return true;
    }
    cells = {fieldAt(x, y), fieldAt(x + 1, y), fieldAt(x, y + 1), fieldAt(x + 1, y + 1)};
    return cells[0] && cells[1] && cells[2] && cells[3];
  }
  /// Probability of a cell being occupied, exactly 0.5 where unseen.
  double probability(int x, int y) const;

  /// Tiles stored, and those of them with a layer that no other grid shares.
  size_t tiles() const;
  size_t ownTiles() const;
  /// Where tiles may lie without the directory growing; all zero for an empty grid.
  GridArea area() const;
  /// Of one cell in both layers.
  static constexpr size_t kCellBytes = sizeof(SeenCell) + sizeof(FieldCell);
  /// The directory has an entry per tile of area(), also where nothing is stored: as much memory as a cell
  /// for so many cells of the area.
  static constexpr double cellsPerDirectoryEntry() {
    return static_cast<double>(kTileCells * kCellBytes) / sizeof(Tile);
  }
  size_t directoryBytes() const { return tiles_.capacity() * sizeof(tiles_[0]); }
  /// Appends the identity and the bytes of every tile's layers, to count those of many grids once.
  void appendParts(std::vector<std::pair<const void*, size_t>>& parts) const;

  /// The part that was seen; without any, one unseen cell.
  OccupancyRaster toRaster() const;
  /// A grid with the raster's cells: occupied ones as surfaces at their centres. The raster's corner is
  /// rounded to a whole cell. Errors: ContractError when the resolutions differ by more than 1e-6.
  static Grid fromRaster(const OccupancyRaster& raster, const GridOptions& options);

 private:
  static constexpr int kTileBits = 5, kTileSide = 1 << kTileBits, kTileMask = kTileSide - 1;
  static constexpr size_t kTileCells = size_t{kTileSide} * kTileSide;
  using SeenLayer = std::array<SeenCell, kTileCells>;
  using FieldLayer = std::array<FieldCell, kTileCells>;
  /// Either is empty where it says nothing.
  struct Tile {
    threads::SharedPart<SeenLayer> seen;
    threads::SharedPart<FieldLayer> field;
    bool empty() const { return !seen && !field; }
  };
  struct Spot {
    int x, y;
  };
  struct Offset {
    std::int8_t x, y;
  };

  static size_t indexInTile(int x, int y) {
    return static_cast<size_t>(((y & kTileMask) << kTileBits) | (x & kTileMask));
  }
  /// nullptr beyond the directory.
  const Tile* tileAt(int tile_x, int tile_y) const {
    const auto column = static_cast<unsigned>(tile_x - tile_x_min_),
               row = static_cast<unsigned>(tile_y - tile_y_min_);
    if (column >= static_cast<unsigned>(tile_columns_) || row >= static_cast<unsigned>(tile_rows_))
      return nullptr;
    return &tiles_[static_cast<size_t>(row) * static_cast<size_t>(tile_columns_) + column];
  }
  Tile& tileFor(int tile_x, int tile_y) { return const_cast<Tile&>(*tileAt(tile_x, tile_y)); }
  const SeenCell* seenAt(int x, int y) const {
    const Tile* tile = tileAt(x >> kTileBits, y >> kTileBits);
    return tile && tile->seen ? &(*tile->seen)[indexInTile(x, y)] : nullptr;
  }
  const FieldCell* fieldAt(int x, int y) const {
    const Tile* tile = tileAt(x >> kTileBits, y >> kTileBits);
    return tile && tile->field ? &(*tile->field)[indexInTile(x, y)] : nullptr;
  }
  void coverTiles(int x_min, int y_min, int x_max, int y_max);
  SeenCell& ownSeen(int x, int y);
  FieldCell& ownField(int x, int y);
  struct Beams;
  std::vector<Spot> pass(const CrossedCells& crossed, const CrossedCells& hit);
  bool addReturn(const Spot& spot, const core::Point2& end, const core::Point2& normal, bool is_first);
  std::vector<Spot> addReturns(const ScanRays& rays, const Beams& beams, CrossedCells& hit);
  void spreadFrom(const Spot& surface);
  void forget(const Spot& surface, std::vector<Spot>& orphans);
  void findNearest(const Spot& cell);
  template <class Change>
  void forDisc(const Spot& centre, const Change& change);

  GridOptions options_;
  int hit_, pass_, most_, least_;
  std::shared_ptr<const std::vector<Offset>> disc_;  ///< by distance, then y, then x
  std::array<int, 17> half_width_{};                 ///< of the disc, at each |y|
  int tile_x_min_ = 0, tile_y_min_ = 0, tile_columns_ = 0, tile_rows_ = 0;
  std::vector<Tile> tiles_;  ///< row-major
};

}  // namespace slam::gridmap
