#pragma once
#include <optional>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/core/random.h"
#include "libslam/world/plan.h"

namespace slam::sim {

/// Nearer than this to where it was a robot is not put down, if there is a choice.
inline constexpr double kCarriedAway_m = 3;

/// A place where a robot of this radius has room, in the part of the plan that it can drive to from
/// T_world_from; in the largest part where it stands in none. Any such cell and any heading are as likely as
/// others. nullopt: no room anywhere. Cost: a pass over the plan.
std::optional<core::Pose2> randomPlace(const world::Plan& plan, const core::Pose2& T_world_from,
                                       double radius_m, core::RandomStream& random);

/// One of these places, with any heading. nullopt: there is none.
std::optional<core::Pose2> placeOf(const std::vector<core::Point2>& visited, const core::Pose2& T_world_from,
                                   core::RandomStream& random);

}  // namespace slam::sim
