#pragma once
#include <cmath>
#include <cstdint>

#include "libslam/core/pose2.h"

namespace slam::core {

/// A cell of an unbounded grid over the plane, as one number: row * 2^32 + column, of which either may be
/// negative.
using PlaneCell = std::int64_t;

/// Which cell of a line a coordinate is in, in cells. Beyond 2^30 of them to either side it is the last one,
/// and so is what is no number: a reading of 1e38 m is somewhere, but nowhere that matters.
inline std::int64_t cellOnLine(double cells) {
  constexpr double kMost = 1 << 30;
  if (!(std::abs(cells) < kMost)) return cells > 0 ? std::int64_t{1} << 30 : -(std::int64_t{1} << 30);
  return static_cast<std::int64_t>(std::floor(cells));
}

/// The cell of side cell_m that holds a point, both in metres and the point in the frame of the grid.
inline PlaneCell planeCell(const Point2& p, double cell_m) {
  return cellOnLine(p.y / cell_m) * (PlaneCell{1} << 32) + cellOnLine(p.x / cell_m);
}

}  // namespace slam::core
