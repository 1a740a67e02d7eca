#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>

#include "libslam/core/plane_cell.h"

namespace slam::choices {

/// A set of places that lie side by side, as bits in tiles of 64 x 64: instead of a node of a
/// hash table each, and most questions meet a tile that is at hand.
class PlaceSet {
 public:
  void insert(core::PlaneCell place) { tiles_[tileOf(place)][rowIn(place)] |= bitOf(place); }
  /// The place of a point, and the eight beside it.
  void insertAround(const core::Point2& p_map, double cell_m) {
    for (const double dy : {-cell_m, 0.0, cell_m})
      for (const double dx : {-cell_m, 0.0, cell_m})
        insert(core::planeCell({p_map.x + dx, p_map.y + dy}, cell_m));
  }
  bool contains(core::PlaneCell place) const {
    const auto tile = tiles_.find(tileOf(place));
    return tile != tiles_.end() && (tile->second[rowIn(place)] & bitOf(place)) != 0;
  }
  void clear() { tiles_.clear(); }

 private:
  static constexpr int kSide_bits = 6;
  static constexpr std::uint64_t kInside = (std::uint64_t{1} << kSide_bits) - 1;
  static std::int32_t columnOf(core::PlaneCell place) { return static_cast<std::int32_t>(place); }
  static std::int32_t rowOf(core::PlaneCell place) {
    return static_cast<std::int32_t>((place - columnOf(place)) >> 32);
  }
  static core::PlaneCell tileOf(core::PlaneCell place) {
    return (rowOf(place) >> kSide_bits) * (core::PlaneCell{1} << 32) + (columnOf(place) >> kSide_bits);
  }
  static std::size_t rowIn(core::PlaneCell place) {
    return static_cast<std::uint64_t>(rowOf(place)) & kInside;
  }
  static std::uint64_t bitOf(core::PlaneCell place) {
    return std::uint64_t{1} << (static_cast<std::uint64_t>(columnOf(place)) & kInside);
  }

  std::unordered_map<core::PlaneCell, std::array<std::uint64_t, std::size_t{1} << kSide_bits>> tiles_;
};

}  // namespace slam::choices
