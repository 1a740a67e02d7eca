#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>

#include "libslam/world/cell_map.h"

namespace slam::rays {

/// What the table says of a ray in cell (u, v), where it came in through the face u or began. A code n from 2
/// to 254 means that columns u to u + n - 2 are free (or outside) for every ray of the octant and that column
/// u + n - 1 exists.
constexpr std::uint8_t kWall = 0, kWallAbove = 1, kLongestSkip = 254, kNeverHits = 255;

/// One of the eight directions that a ray may take: which axis it follows, and which way along each.
struct Octant {
  bool x_is_major = true, x_falls = false, y_falls = false;

  std::size_t index() const { return (x_is_major ? 4U : 0U) + (x_falls ? 2U : 0U) + (y_falls ? 1U : 0U); }
};

/// For each octant of direction and each cell of a map, how many columns of the major axis a ray may skip
/// whatever its slope: K(u, v) = 1 + min(K(u + 1, v), K(u + 1, v + 1)) where (u, v) and (u, v + 1) are free.
/// The walk of castRay() may restart at any column, so a skip costs no exactness.
///
/// Memory: 8 bytes per cell, and one more row and column of cells outside the map, rounded up to whole
/// tiles: cells lie in tiles of 8 x 8, one cache line each, because the rays of a scan look at neighbouring
/// cells of neighbouring columns.
class SectorTable {
 public:
  /// ContractError for a map of more than 2^15 cells on a side.
  explicit SectorTable(const world::CellMap& map);

  /// Cells x0 .. x1-1 by y0 .. y1-1 of the map have other walls now: the table becomes what a new one would
  /// be. REQUIRES a map of the same size that differs from the known one nowhere else. Cost: the cells from
  /// which the change is seen within 254 columns.
  void update(const world::CellMap& map, int x0, int y0, int x1, int y1);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  /// Codes over cells counted from the octant's own corner: cell (u, v) is at offsetOf(tiles(octant), u, v).
  /// Three bytes behind the last code of all octants may be read.
  const std::uint8_t* codes(const Octant& octant) const {
    return codes_.get() + octant.index() * octant_size_;
  }
  /// Tiles along the minor axis.
  int tiles(const Octant& octant) const { return tilesFor(octant.x_is_major ? rows_ : columns_); }

  static constexpr int kTileSide = 8, kTileCells = 64;
  static std::ptrdiff_t offsetOf(int tiles, int u, int v) {
    const std::ptrdiff_t tile_u = u >> 3, in_tile_u = u & 7;
    return (tile_u * tiles + (v >> 3)) * kTileCells + in_tile_u * kTileSide + (v & 7);
  }

 private:
  struct Free {
    void operator()(std::uint8_t* bytes) const;
  };
  /// For `cells` of an axis and one outside.
  static int tilesFor(int cells) { return cells / kTileSide + 1; }
  std::uint8_t* codes(const Octant& octant) { return codes_.get() + octant.index() * octant_size_; }

  int columns_, rows_;
  std::size_t octant_size_;
  std::unique_ptr<std::uint8_t, Free> codes_;
};

}  // namespace slam::rays
