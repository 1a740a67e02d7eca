#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::gridmap {

/// A set of cells within a rectangle, one bit each, in words of 32 neighbours along x that lie on multiples
/// of 32.
class CrossedCells {
 public:
  /// Both corners belong to the rectangle.
  CrossedCells(int x_min, int y_min, int x_max, int y_max)
      : column_min_(x_min >> 5),
        column_max_(x_max >> 5),
        row_min_(y_min >> 5),
        row_max_(y_max >> 5),
        stride_(static_cast<size_t>(column_max_ - column_min_ + 1)) {
    words_.resize(stride_ * static_cast<size_t>((row_max_ - row_min_ + 1) * 32));
  }

  int tileColumnMin() const { return column_min_; }
  int tileColumnMax() const { return column_max_; }
  int tileRowMin() const { return row_min_; }
  int tileRowMax() const { return row_max_; }
  /// Cells 32 * tile_column + 0 .. 31 of row y, the first as the lowest bit.
  std::uint32_t word(int tile_column, int y) const {
    return words_[static_cast<size_t>(y - row_min_ * 32) * stride_ +
                  static_cast<size_t>(tile_column - column_min_)];
  }
  void add(int x, int y) { wordOf(x, y) |= 1U << (x & 31); }
  /// Takes a cell out; whether it was in.
  bool take(int x, int y) {
    std::uint32_t& bits = wordOf(x, y);
    const std::uint32_t mask = 1U << (x & 31);
    const bool was = (bits & mask) != 0;
    bits &= ~mask;
    return was;
  }
  /// Every cell that the closed segment touches, where a cell owns its lower and its left border. In units of
  /// cells.
  void addLine(const core::Point2& from, const core::Point2& to);

 private:
  std::uint32_t& wordOf(int x, int y) {
    return words_[static_cast<size_t>(y - row_min_ * 32) * stride_ +
                  static_cast<size_t>((x >> 5) - column_min_)];
  }
  int column_min_, column_max_, row_min_, row_max_;
  size_t stride_;
  std::vector<std::uint32_t> words_;
};

}  // namespace slam::gridmap
