#pragma once
#include <optional>

#include "libslam/core/pose2.h"

namespace mrpt::obs {
class CActionCollection;
}

namespace slam::logs {

/// How the robot moved, by the wheel odometry among the actions (CActionRobotMovement2D of kind emOdometry, its raw
/// reading), else by the mean of a scan matching one, else of a CActionRobotMovement3D; nullopt without any.
std::optional<core::Pose2> incrementOf(const mrpt::obs::CActionCollection& actions);

}  // namespace slam::logs
