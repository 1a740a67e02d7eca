#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libslam/scanmatch/surfel_map.h"

namespace slam::bundle {

/// Of a keyframe's points in a cell those that are seen from one side: sums from the cell's centre, as
/// scanmatch::ScanInCells has them.
struct PointsInCell {
  std::int32_t row, column, keyframe;
  float n, x, y, xx, xy, yy, nx, ny;
  std::int8_t reach;                  ///< cells around that show that they are of a wall; 0: they are not
  std::int8_t rows_off, columns_off;  ///< the cell that the middle of their wall is in, until they are there
};

inline bool areOnOneSide(float ax, float ay, float bx, float by) {
  return ax * bx + ay * by >= 0;
}
inline bool areOnOneSide(const PointsInCell& a, const PointsInCell& b) {
  return areOnOneSide(a.nx, a.ny, b.nx, b.ny);
}

/// Points whose normals are all within a quarter turn: what is asked of the outermost two holds for all.
class Fan {
 public:
  explicit Fan(const PointsInCell& first)
      : right_x_(first.nx), right_y_(first.ny), left_x_(first.nx), left_y_(first.ny) {}
  /// Not where there is no normal: that is on every side.
  bool takes(const PointsInCell& one) const {
    return right_x_ * one.nx + right_y_ * one.ny > 0 && left_x_ * one.nx + left_y_ * one.ny > 0;
  }
  /// REQUIRES one that it takes.
  void add(const PointsInCell& one) {
    if (right_x_ * one.ny < right_y_ * one.nx) right_x_ = one.nx, right_y_ = one.ny;
    if (left_x_ * one.ny > left_y_ * one.nx) left_x_ = one.nx, left_y_ = one.ny;
  }
  bool areAllOnSideOf(const PointsInCell& one) const { return rightIs(one) && leftIs(one); }
  bool isAnyOnSideOf(const PointsInCell& one) const { return rightIs(one) || leftIs(one); }

 private:
  bool rightIs(const PointsInCell& one) const { return areOnOneSide(right_x_, right_y_, one.nx, one.ny); }
  bool leftIs(const PointsInCell& one) const { return areOnOneSide(left_x_, left_y_, one.nx, one.ny); }
  float right_x_, right_y_, left_x_, left_y_;
};

/// Keyframes' points by cell, those of a keyframe in a cell as one where they are seen from one side. What
/// lies around a cell is summed up cell by cell.
class PointsByCell {
 public:
  static constexpr int kReach = 2;  ///< so far around cells one can look
  using Sums = scanmatch::ScanInCells::Sums;

  struct Cell {
    std::int32_t row, column;
    std::uint32_t begin, end;              ///< of its points, see at()
    std::uint32_t first_side, after_side;  ///< of its sides
    /// In each row so far around: the first cell that is at most so many columns before, or what is after it.
    std::array<std::uint32_t, 2 * kReach + 1> first_near;
  };

  /// Keyframes come in ascending order.
  void add(const PointsInCell& points) { all_.push_back(points); }
  /// All that was added, and not been made part of others: may be moved to other cells until sumUp().
  std::vector<PointsInCell>& all() { return all_; }
  /// Sorts by cell and sums up; ends what was said of cells before.
  void sumUp();

  /// By row, then by column.
  const std::vector<Cell>& cells() const { return cells_; }
  /// Of a cell, by keyframe.
  PointsInCell& at(std::size_t i) { return all_[places_[i].index]; }
  const PointsInCell& at(std::size_t i) const { return all_[places_[i].index]; }
  /// What lies in a cell and so far around it, seen from the side that `first` is seen from; from the cell's
  /// centre.
  Sums around(const Cell& cell, int reach, const PointsInCell& first, double cell_m) const;

 private:
  struct Place {
    std::int32_t row, column;
    std::uint32_t index;
  };
  /// Points of a cell that are seen from about one side.
  struct Side {
    Fan fan;
    Sums sums;
  };
  void sort();
  template <class KeyOf>
  void sortBy(const KeyOf& key_of, std::vector<Place>& sorted);
  static bool areInOneCell(const Place& a, const Place& b) { return a.row == b.row && a.column == b.column; }
  std::size_t sumUpKeyframe(std::size_t begin, std::size_t end, std::size_t to);
  void endCell(std::size_t begin, std::size_t end);
  void findNear();
  void addCell(const Cell& cell, const PointsInCell& first, double x_m, double y_m, Sums& sums) const;

  std::vector<PointsInCell> all_;  ///< those that are part of others have no points
  std::vector<Place> places_;
  std::vector<Cell> cells_;
  std::vector<Side> sides_;
};

/// As sums of doubles.
inline PointsByCell::Sums sumsOf(const PointsInCell& one) {
  return {one.n, one.x, one.y, one.xx, one.xy, one.yy, one.nx, one.ny};
}

}  // namespace slam::bundle
