#include "libslam/rays/original_ray.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/core/numbers.h"
#include "libslam/rays/ray_walk.h"

namespace slam::rays {

double castOriginalRay(const world::Plan& plan, const core::Point2& origin_world, double angle_rad,
                       double max_range_m) {
  using core::kInfinity;
  const core::Point2 origin = world::pointToCells(plan, origin_world),
                     direction = rayDirection(plan, angle_rad);
  if (!isFiniteRay(origin, direction)) return kInfinity;
  const double column = std::floor(origin.x), row = std::floor(origin.y);
  if (!(column >= 0 && row >= 0 && column < plan.columns && row < plan.rows)) return kInfinity;

  const double longer = std::max(std::abs(direction.x), std::abs(direction.y));
  for (int step = 0;; ++step) {
    const double right = std::round(step * direction.x / longer),
                 up = std::round(step * direction.y / longer);
    const int at_column = static_cast<int>(column + right), at_row = static_cast<int>(row + up);
    if (!plan.contains(at_column, at_row)) return kInfinity;
    if (plan.at(at_column, at_row) != world::Cell::kOccupied) continue;
    const double range_m = std::round(core::hypot(right, up)) * plan.resolution_m;
    return max_range_m > 0 && range_m > max_range_m ? kInfinity : range_m;
  }
}

}  // namespace slam::rays
