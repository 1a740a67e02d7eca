#include "libslam/sim/sightings.h"

#include "libslam/core/elementary.h"
#include "libslam/rays/ray_caster.h"

namespace slam::sim {

std::vector<Sighting> sightings(const world::Plan& plan, const core::Pose2& T_world_robot,
                                const std::vector<core::Point2>& robots_world) {
  const core::Point2 here = core::position(T_world_robot);
  const core::Pose2 T_robot_world = core::inverse(T_world_robot);
  std::vector<Sighting> seen;
  for (std::size_t i = 0; i < robots_world.size(); ++i) {
    const core::Point2& there = robots_world[i];
    const double distance_m = core::distance(here, there);
    const auto isHidden = [&] {
      const double angle_rad = core::atan2(there.y - here.y, there.x - here.x);
      return rays::castRay(plan, here, angle_rad, kMarkRange_m) < distance_m;
    };
    if (distance_m > kMarkRange_m || (distance_m > kNearby_m && isHidden())) continue;
    seen.push_back({i, T_robot_world * there});
  }
  return seen;
}

}  // namespace slam::sim
