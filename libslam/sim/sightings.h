#pragma once
#include <cstddef>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/world/plan.h"

namespace slam::sim {

/// Another robot that is seen.
struct Sighting {
  std::size_t robot;     ///< its place among those that were asked for
  core::Point2 p_robot;  ///< its centre in the frame of the one that looks; exact
};

/// Which robots one sees: robots carry a mark that tells them apart and tells where their centre is, up to
/// kMarkRange_m with no wall of the plan in between, and within kNearby_m also round a corner. In the field
/// that is a lamp or a reflector; here it is without noise. Other robots hide none.
std::vector<Sighting> sightings(const world::Plan& plan, const core::Pose2& T_world_robot,
                                const std::vector<core::Point2>& robots_world);
inline constexpr double kMarkRange_m = 8.0, kNearby_m = 1.5;

}  // namespace slam::sim
