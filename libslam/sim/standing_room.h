#pragma once
#include <string>

#include "libslam/core/pose2.h"
#include "libslam/world/plan.h"

namespace slam::sim {

/// Why a robot whose circle has that radius cannot stand there, by the plan alone: "not finite", "outside the
/// plan", "in a wall", "too near to a wall"; "" when it can.
std::string refusalOf(const world::Plan& plan, const core::Pose2& T_world_robot, double radius_m);

/// Errors: InputError with the plan, `what` ("start pose"), the pose, the refusal and the radius.
void requireStandingRoom(const world::Plan& plan, const std::string& what, const core::Pose2& T_world_robot,
                         double radius_m);

}  // namespace slam::sim
