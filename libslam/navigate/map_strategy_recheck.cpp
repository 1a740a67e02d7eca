#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/navigate/map_strategy.h"

/// Whether what was decided still holds.
namespace slam::navigate {
namespace {

constexpr double kWorthGoing = 0.3;  // of the frontier cells still there

}  // namespace

bool MapStrategy::isStillGood(const Decision& decision, const core::Pose2& T_map_robot,
                              std::size_t next_waypoint) {
  if (!space_ || decision.path.empty()) return true;
  // By what is certainly in the way, without the planning margin: a path along its edge must not flicker.
  const double radius_m = robot::circumscribedRadius(robot_) - space_->resolution_m;
  const int reach = static_cast<int>(std::ceil(radius_m / space_->resolution_m));
  const auto blocked = [&](const core::Point2& p) {
    const int column = space_->columnOf(p.x), row = space_->rowOf(p.y);
    for (int dr = -reach; dr <= reach; ++dr)
      for (int dc = -reach; dc <= reach; ++dc)
        if (core::hypot(dc, dr) * space_->resolution_m <= radius_m &&
            space_->contains(column + dc, row + dr) &&
            space_->state[space_->index(column + dc, row + dr)] == paths::kOccupiedCell)
          return true;
    return false;
  };
  core::Point2 from = core::position(T_map_robot);
  for (std::size_t i = next_waypoint; i < decision.path.size(); from = decision.path[i++]) {
    const core::Point2& to = decision.path[i];
    const int steps = static_cast<int>(std::ceil(core::distance(from, to) / (2 * space_->resolution_m)));
    // Not where the robot stands: by the noisy map it may already touch something.
    for (int k = 1; k <= steps; ++k) {
      const double s = static_cast<double>(k) / steps;
      const core::Point2 p{from.x + s * (to.x - from.x), from.y + s * (to.y - from.y)};
      if (core::distance(p, core::position(T_map_robot)) > 0.2 && blocked(p)) return false;
    }
  }
  if (!options_.recheck || target_.empty()) return true;
  std::size_t left = 0;
  for (const auto& p : target_) {
    const int column = space_->columnOf(p.x), row = space_->rowOf(p.y);
    left += column > 0 && row > 0 && column + 1 < space_->columns && row + 1 < space_->rows &&
            paths::isFrontierCell(*space_, space_->index(column, row)) && returns_.count(placeOf(p)) == 0;
  }
  return static_cast<double>(left) >= kWorthGoing * static_cast<double>(target_.size());
}

}  // namespace slam::navigate
