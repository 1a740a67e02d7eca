#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "libslam/core/pose2.h"
#include "libslam/world/plan.h"

namespace slam::metrics {

/// One axis of the plan in cells, mirrored where the ray runs down it, so that the ray grows along it: a
/// coordinate is negated and cell k becomes cell -k - 1, both without rounding.
struct GrowingAxis {
  double origin, direction;
  int begin, end;
  std::ptrdiff_t stride, offset;  ///< cell k stands at k * stride + offset of the plan's cells

  GrowingAxis(double ray_origin, double cosine, int size, std::ptrdiff_t plan_stride)
      : origin(cosine < 0 ? -ray_origin : ray_origin),
        direction(std::abs(cosine)),
        begin(cosine < 0 ? -size : 0),
        end(begin + size),
        stride(cosine < 0 ? -plan_stride : plan_stride),
        offset(cosine < 0 ? -plan_stride : 0) {}
  int cellOfOrigin() const { return static_cast<int>(std::floor(origin)); }
  bool contains(int cell) const { return cell >= begin && cell < end; }
};

/// Calls visit(index of Plan::cells) for every cell that a ray enters, in order and the first one included,
/// until it returns false, the plan ends or the range does: the walk of world::castRay() (its header states
/// the arithmetic); all in cells. REQUIRES an origin in the plan.
template <class Visit>
void walkRay(const world::Plan& plan, const core::Point2& origin, double angle_in_plan,
             double max_range_cells, Visit visit) {
  const GrowingAxis x(origin.x, std::cos(angle_in_plan), plan.columns, 1);
  const GrowingAxis y(origin.y, std::sin(angle_in_plan), plan.rows, plan.columns);
  const GrowingAxis& major = x.direction >= y.direction ? x : y;
  const GrowingAxis& minor = x.direction >= y.direction ? y : x;
  const double slope = std::min(minor.direction / major.direction, 1 - std::ldexp(1.0, -36));
  const auto seeAndPass = [&](int u, int v) {
    return visit(static_cast<size_t>(u * major.stride + major.offset + v * minor.stride + minor.offset));
  };

  int u = major.cellOfOrigin(), v = minor.cellOfOrigin();
  if (!major.contains(u) || !minor.contains(v) || !seeAndPass(u, v)) return;
  while (true) {
    if (minor.origin + (u + 1 - major.origin) * slope >= v + 1) {
      ++v;
      if (v - minor.origin > max_range_cells * minor.direction) return;
      if (v >= minor.end || !seeAndPass(u, v)) return;
    }
    ++u;
    if (u - major.origin > max_range_cells * major.direction) return;
    if (u >= major.end || !seeAndPass(u, v)) return;
  }
}

}  // namespace slam::metrics
