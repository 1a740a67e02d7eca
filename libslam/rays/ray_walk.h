#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "libslam/core/numbers.h"
#include "libslam/core/pose2.h"
#include "libslam/world/cell_map.h"

namespace slam::rays {

/// One axis of a map in cells, mirrored where a ray runs down it so that the ray always grows along it. Cell
/// k of the map is cell -k - 1 of its mirror image: negation is exact, so the image costs no bit.
struct GrowingAxis {
  double origin;        ///< of the ray, cells
  double direction;     ///< cosine of the ray with the axis, >= 0
  int begin, end;       ///< cells begin .. end-1 exist
  std::ptrdiff_t step;  ///< from a cell to the next in CellMap::cells
  std::ptrdiff_t zero;  ///< index contribution of cell 0

  bool contains(double coordinate) const {
    const double cell = std::floor(coordinate);
    return cell >= begin && cell < end;
  }
};

inline GrowingAxis growingAxis(double origin, double direction, int size, std::ptrdiff_t stride) {
  if (direction >= 0) return {origin, direction, 0, size, stride, 0};
  return {-origin, -direction, -size, 0, -stride, -stride};
}

inline bool isFiniteRay(const core::Point2& origin, const core::Point2& direction) {
  return std::isfinite(origin.x) && std::isfinite(origin.y) && std::isfinite(direction.x) &&
         std::isfinite(direction.y);
}

/// Rows per column. Below 1, so that a ray climbs at most one row per column even after rounding: the two
/// products and sums of row(u + 1) - row(u) err by less than 2^-36 together while coordinates stay below 2^15
/// cells.
inline double raySlope(const GrowingAxis& major, const GrowingAxis& minor) {
  constexpr double kSteepest = 1.0 - 0x1.0p-36;
  return std::min(minor.direction / major.direction, kSteepest);
}

/// Where the ray meets the near face of column u, in cells of the minor axis. It never falls as u grows, so
/// its floor is the row in which a walk enters any column after its first.
inline double rowAt(const GrowingAxis& major, const GrowingAxis& minor, double slope, int u) {
  return minor.origin + (u - major.origin) * slope;
}

/// How a walk enters a cell: through the face on one of the ray's lines u = line or v = line.
class RayEntry {
 public:
  RayEntry(const GrowingAxis& major, const GrowingAxis& minor, int u, int line, bool through_minor_face)
      : major_(major), minor_(minor), u_(u), line_(line), through_minor_face_(through_minor_face) {}

  /// From the ray's origin, in cells; never negative.
  double distance() const {
    if (!through_minor_face_) return std::max(0.0, line_ - major_.origin) / major_.direction;
    const double entry = (line_ - minor_.origin) / minor_.direction;
    // A ray almost parallel to the line meets it at an ill-conditioned place; column u still bounds it.
    const double nearest = std::max(0.0, u_ - major_.origin) / major_.direction;
    const double farthest = (u_ + 1 - major_.origin) / major_.direction;
    return std::min(std::max(entry, nearest), farthest);
  }
  /// distance() <= limit but for rounding, without a division.
  bool isWithin(double limit) const {
    const GrowingAxis& crossed = through_minor_face_ ? minor_ : major_;
    return line_ - crossed.origin <= limit * crossed.direction;
  }

 private:
  const GrowingAxis &major_, &minor_;
  int u_, line_;
  bool through_minor_face_;
};

/// The walk whose arithmetic castRay() states: calls go_on(const Cell*, RayEntry) for every cell
/// that the ray enters, first that of its origin (distance 0), in order, until it answers false or the map
/// ends. Origin (column, row as reals) and direction (a unit vector) in cells of the map; nothing is visited
/// from outside the map or when one of them is not finite. `limit` in cells only ends the walk early, up to
/// two columns late: compare entries exactly where it matters.
template <class GoOn>
void walkRay(const world::CellMap& map, const core::Point2& origin, const core::Point2& direction,
             double limit, GoOn go_on) {
  if (!isFiniteRay(origin, direction)) return;
  const GrowingAxis x = growingAxis(origin.x, direction.x, map.columns, 1);
  const GrowingAxis y = growingAxis(origin.y, direction.y, map.rows, map.columns);
  const GrowingAxis major = x.direction >= y.direction ? x : y, minor = x.direction >= y.direction ? y : x;

  if (!major.contains(major.origin) || !minor.contains(minor.origin)) return;
  int u = static_cast<int>(std::floor(major.origin)), v = static_cast<int>(std::floor(minor.origin));
  const world::Cell* cell = map.cells.data() + major.zero + minor.zero + u * major.step + v * minor.step;
  if (!go_on(cell, RayEntry(major, minor, u, u, false))) return;

  const double slope = raySlope(major, minor);
  // Two columns more than the range needs: rounding must not end a walk before the last hit within range.
  const double last_u = major.origin + limit * major.direction + 2;
  const int end_u = last_u < major.end ? static_cast<int>(last_u) : major.end;
  while (true) {
    if (rowAt(major, minor, slope, u + 1) >= v + 1) {
      ++v;
      cell += minor.step;
      if (v >= minor.end || !go_on(cell, RayEntry(major, minor, u, v, true))) return;
    }
    ++u;
    cell += major.step;
    if (u >= end_u || !go_on(cell, RayEntry(major, minor, u, u, false))) return;
  }
}

/// The unit vector in the map's axes.
inline core::Point2 rayDirection(const world::CellMap& map, double angle_rad) {
  const double angle_in_raster = angle_rad - map.T_frame_raster.phi;
  return core::polar(1, angle_in_raster);
}

/// A ray in metres along a unit vector in the map's axes from a cast in cells: `cast(direction, limit)`
/// answers the distance in cells and may answer anything greater than `limit` for hits beyond it. Infinity
/// beyond max_range_m; <= 0 means no limit.
template <class Cast>
double castInMetres(const world::CellMap& map, const core::Point2& direction, double max_range_m, Cast cast) {
  using core::kInfinity;
  const double limit_m = max_range_m > 0 ? max_range_m : kInfinity;
  const double distance_m = map.resolution_m * cast(direction, limit_m / map.resolution_m);
  return distance_m <= limit_m ? distance_m : kInfinity;
}

}  // namespace slam::rays
