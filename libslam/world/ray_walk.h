#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "libslam/core/pose2.h"
#include "libslam/world/plan.h"

namespace slam::world {

/// One axis of a plan in cells, mirrored where a ray runs down it so that the ray always grows along it. Cell
/// k of the plan is cell -k - 1 of its mirror image: negation is exact, so the image costs no bit.
struct GrowingAxis {
  double origin;        ///< of the ray, cells
  double direction;     ///< cosine of the ray with the axis, >= 0
  int begin, end;       ///< cells begin .. end-1 exist
  std::ptrdiff_t step;  ///< from a cell to the next in Plan::cells
  std::ptrdiff_t zero;  ///< index contribution of cell 0
};

inline GrowingAxis growingAxis(double origin, double direction, int size, std::ptrdiff_t stride) {
  if (direction >= 0) return {origin, direction, 0, size, stride, 0};
  return {-origin, -direction, -size, 0, -stride, -stride};
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
/// that the ray enters, first that of its origin (distance 0), in order, until it answers false or the plan
/// ends. Origin (column, row as reals) and direction (a unit vector) in cells of the plan; nothing is visited
/// from outside the plan or when one of them is not finite. `limit` in cells only ends the walk early, up to
/// two columns late: compare entries exactly where it matters.
template <class GoOn>
void walkRay(const Plan& plan, const core::Point2& origin, const core::Point2& direction, double limit,
             GoOn go_on) {
  // Below 1, so that a ray climbs at most one row per column even after rounding: the two products and sums
  // of row(u + 1) - row(u) err by less than 2^-36 together while coordinates stay below 2^15 cells.
  constexpr double kSteepest = 1.0 - 0x1.0p-36;
  const bool is_finite = std::isfinite(origin.x) && std::isfinite(origin.y) && std::isfinite(direction.x) &&
                         std::isfinite(direction.y);
  if (!is_finite) return;
  const GrowingAxis x = growingAxis(origin.x, direction.x, plan.columns, 1);
  const GrowingAxis y = growingAxis(origin.y, direction.y, plan.rows, plan.columns);
  const GrowingAxis major = x.direction >= y.direction ? x : y, minor = x.direction >= y.direction ? y : x;

  const double floor_u = std::floor(major.origin), floor_v = std::floor(minor.origin);
  if (!(floor_u >= major.begin && floor_u < major.end && floor_v >= minor.begin && floor_v < minor.end))
    return;
  int u = static_cast<int>(floor_u), v = static_cast<int>(floor_v);
  const Cell* cell = plan.cells.data() + major.zero + minor.zero + u * major.step + v * minor.step;
  if (!go_on(cell, RayEntry(major, minor, u, u, false))) return;

  const double slope = std::min(minor.direction / major.direction, kSteepest);
  // Two columns more than the range needs: rounding must not end a walk before the last hit within range.
  const double last_u = major.origin + limit * major.direction + 2;
  const int end_u = last_u < major.end ? static_cast<int>(last_u) : major.end;
  while (true) {
    const double row_at_far_side = minor.origin + (u + 1 - major.origin) * slope;
    if (row_at_far_side >= v + 1) {
      ++v;
      cell += minor.step;
      if (v >= minor.end || !go_on(cell, RayEntry(major, minor, u, v, true))) return;
    }
    ++u;
    cell += major.step;
    if (u >= end_u || !go_on(cell, RayEntry(major, minor, u, u, false))) return;
  }
}

}  // namespace slam::world
