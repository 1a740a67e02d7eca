#pragma once
#include <optional>
#include <vector>

#include "libslam/world/plan.h"

namespace slam::world {

/// A way for a disc through a known plan.
struct DiscPath {
  double length_m = 0;
  std::vector<core::Point2> corners;  ///< world frame, the start first
};

/// The shortest way of a disc from `from` to within tolerance_m of `to`: A* over the cells whose centre is
/// free for the disc (discCollides), eight neighbours each, then pulled tight between cells that see each
/// other. At most a few percent longer than the shortest way; nullopt when there is none, also when the disc
/// does not fit at `from`. Cost: the cells that the search visits, times those under the disc.
std::optional<DiscPath> shortestPath(const Plan& plan, const core::Point2& from, const core::Point2& to,
                                     double radius_m, double tolerance_m);

}  // namespace slam::world
