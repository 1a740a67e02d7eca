#include "libslam/rays/sector_table.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <new>
#include <vector>

#include "libslam/core/error.h"

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace slam::rays {
namespace {

constexpr std::size_t kPadding = 3;

/// Uninitialised, and in huge pages where the system has them: random rays in a large map then miss the
/// translation buffers less.
std::uint8_t* allocate(std::size_t size) {
  constexpr std::size_t kHugePage = std::size_t{1} << 21;
  const std::size_t alignment = size >= kHugePage ? kHugePage : 64;
  const std::size_t rounded = (size + alignment - 1) / alignment * alignment;
  void* bytes = std::aligned_alloc(alignment, rounded);
  if (bytes == nullptr) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
  if (size >= kHugePage) madvise(bytes, rounded, MADV_HUGEPAGE);  // a hint: may fail, then pages are small
#endif
  return static_cast<std::uint8_t*>(bytes);
}

/// The code of a free cell below a free cell whose successors have codes with this minimum.
inline std::uint8_t codeBefore(std::uint8_t successors) {
  const std::uint8_t code =
      std::max(successors, kWallAbove);  // the next column has to be looked at either way
  return static_cast<std::uint8_t>(code + (code < kLongestSkip));
}

/// `count` codes of one column from its walls (one more of them) and from the codes of the column after it
/// (one more as well).
void fillColumn(const std::uint8_t* __restrict wall, const std::uint8_t* __restrict next, int count,
                std::uint8_t* __restrict codes) {
  for (int v = 0; v < count; ++v) {
    const std::uint8_t free_code = codeBefore(std::min(next[v], next[v + 1]));
    const std::uint8_t below_wall = wall[v + 1] != 0 ? kWallAbove : free_code;
    codes[v] = wall[v] != 0 ? kWall : below_wall;
  }
}

/// Walls of the map, 1 or 0, with the minor axis contiguous.
std::vector<std::uint8_t> wallsOf(const world::CellMap& map, bool x_is_major) {
  constexpr int kBlock = 64;  // a transposition by blocks keeps both sides in the cache
  const size_t columns = static_cast<size_t>(map.columns), rows = static_cast<size_t>(map.rows);
  std::vector<std::uint8_t> walls(columns * rows);
  if (!x_is_major) {
    std::transform(map.cells.begin(), map.cells.end(), walls.begin(), [](world::Cell cell) {
      return static_cast<std::uint8_t>(cell == world::Cell::kOccupied);
    });
    return walls;
  }
  for (size_t row = 0; row < rows; row += kBlock)
    for (size_t column = 0; column < columns; column += kBlock)
      for (size_t r = row; r < std::min(rows, row + kBlock); ++r)
        for (size_t c = column; c < std::min(columns, column + kBlock); ++c)
          walls[c * rows + r] = map.cells[r * columns + c] == world::Cell::kOccupied;
  return walls;
}

constexpr std::ptrdiff_t kSide = SectorTable::kTileSide;

/// Puts a whole column, `tiles` * 8 codes, into its places.
void storeColumn(const std::uint8_t* column, int tiles, int u, std::uint8_t* codes) {
  std::uint8_t* to = codes + SectorTable::offsetOf(tiles, u, 0);
  for (int tile = 0; tile < tiles; ++tile)
    std::memcpy(to + tile * kSide * kSide, column + tile * kSide, SectorTable::kTileSide);
}

/// One octant; `walls` has `size_u` lines of `size_v`.
void fillOctant(const std::vector<std::uint8_t>& walls, int size_u, int size_v, bool u_falls, bool v_falls,
                int tiles, std::uint8_t* codes) {
  const size_t padded = static_cast<size_t>(tiles) * SectorTable::kTileSide;
  std::vector<std::uint8_t> wall(padded + 1, 0), next(padded + 1, kNeverHits), column(padded + 1, kNeverHits);
  const int columns = (size_u / SectorTable::kTileSide + 1) * SectorTable::kTileSide;
  for (int u = columns - 1; u >= size_u; --u) storeColumn(next.data(), tiles, u, codes);
  for (int u = size_u - 1; u >= 0; --u) {
    const std::uint8_t* line = walls.data() + static_cast<size_t>(u_falls ? size_u - 1 - u : u) * size_v;
    if (v_falls)
      std::reverse_copy(line, line + size_v, wall.begin());
    else
      std::copy(line, line + size_v, wall.begin());
    fillColumn(wall.data(), next.data(), size_v, column.data());
    storeColumn(column.data(), tiles, u, codes);
    std::swap(column, next);
  }
}

/// begin .. end-1, empty when end <= begin.
struct Span {
  int begin = 0, end = 0;
  bool empty() const { return end <= begin; }
};

Span hull(const Span& a, const Span& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {std::min(a.begin, b.begin), std::max(a.end, b.end)};
}

/// The same cells counted from the other end of an axis of this size.
Span mirrored(const Span& span, bool mirror, int size) {
  return mirror ? Span{size - span.end, size - span.begin} : span;
}

template <class AnyOctant>
void forEachOctant(AnyOctant do_octant) {
  for (const bool x_is_major : {false, true})
    for (const bool x_falls : {false, true})
      for (const bool y_falls : {false, true}) do_octant(Octant{x_is_major, x_falls, y_falls});
}

/// Carries a change of walls in `changed_u` by `changed_v` to all codes of the octant that depend on it: from
/// the last column back to the first that nothing changed in.
void updateOctant(const world::CellMap& map, const Octant& octant, const Span& changed_u,
                  const Span& changed_v, int tiles, std::uint8_t* codes) {
  const int size_v = octant.x_is_major ? map.rows : map.columns;
  const auto isWall = [&](int u, int v) {
    const int along_x = octant.x_is_major ? u : v, along_y = octant.x_is_major ? v : u;
    return v < size_v && map.at(octant.x_falls ? map.columns - 1 - along_x : along_x,
                                octant.y_falls ? map.rows - 1 - along_y : along_y) == world::Cell::kOccupied;
  };
  const size_t room = static_cast<size_t>(size_v) + 2;
  std::vector<std::uint8_t> wall(room), next(room), column(room);
  Span dirty;
  for (int u = changed_u.end - 1; u >= 0; --u) {
    // A code depends on its own cell, the one above, and the two of the next column.
    const bool own = u >= changed_u.begin;
    Span span = hull(own ? Span{changed_v.begin - 1, changed_v.end} : Span{},
                     dirty.empty() ? Span{} : Span{dirty.begin - 1, dirty.end});
    if (span.empty()) return;
    span.begin = std::max(span.begin, 0);
    for (int v = span.begin; v <= span.end; ++v) {
      wall[v] = isWall(u, v);
      next[v] = codes[SectorTable::offsetOf(tiles, u + 1, v)];
    }
    fillColumn(wall.data() + span.begin, next.data() + span.begin, span.end - span.begin,
               column.data() + span.begin);
    const Span looked_at = span;
    const auto differs = [&](int v) { return column[v] != codes[SectorTable::offsetOf(tiles, u, v)]; };
    while (!span.empty() && !differs(span.begin)) ++span.begin;
    while (!span.empty() && !differs(span.end - 1)) --span.end;
    for (int v = looked_at.begin; v < looked_at.end; ++v)
      codes[SectorTable::offsetOf(tiles, u, v)] = column[v];
    dirty = span;
  }
}

/// The longest side: up to here castRay() is proved, and a column and a row have 16 bits each in a march.
int requireSide(int cells) {
  constexpr int kLongest = 1 << 15;
  if (cells > kLongest) throw core::ContractError("SectorTable: a plan of more than 2^15 cells on a side");
  return cells;
}

}  // namespace

void SectorTable::Free::operator()(std::uint8_t* bytes) const {
  std::free(bytes);
}

SectorTable::SectorTable(const world::CellMap& map)
    : columns_(requireSide(map.columns)),
      rows_(requireSide(map.rows)),
      octant_size_(static_cast<size_t>(tilesFor(map.columns)) * tilesFor(map.rows) * kTileSide * kTileSide),
      codes_(allocate(8 * octant_size_ + kPadding)) {
  std::fill_n(codes_.get() + 8 * octant_size_, kPadding, kNeverHits);
  std::vector<std::uint8_t> walls;
  forEachOctant([&](const Octant& octant) {
    if (!octant.x_falls && !octant.y_falls) walls = wallsOf(map, octant.x_is_major);
    fillOctant(walls, octant.x_is_major ? columns_ : rows_, octant.x_is_major ? rows_ : columns_,
               octant.x_is_major ? octant.x_falls : octant.y_falls,
               octant.x_is_major ? octant.y_falls : octant.x_falls, tiles(octant), codes(octant));
  });
}

void SectorTable::update(const world::CellMap& map, int x0, int y0, int x1, int y1) {
  if (map.columns != columns_ || map.rows != rows_)
    throw core::ContractError("SectorTable::update: the plan has another size");
  const Span x{std::max(x0, 0), std::min(x1, columns_)}, y{std::max(y0, 0), std::min(y1, rows_)};
  if (x.empty() || y.empty()) return;
  forEachOctant([&](const Octant& octant) {
    const Span along_x = mirrored(x, octant.x_falls, columns_), along_y = mirrored(y, octant.y_falls, rows_);
    updateOctant(map, octant, octant.x_is_major ? along_x : along_y, octant.x_is_major ? along_y : along_x,
                 tiles(octant), codes(octant));
  });
}

}  // namespace slam::rays
