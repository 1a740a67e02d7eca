#pragma once
// For the .cpp files of this room only: small pieces of MRPT's objects, made and read.
#include <cstdint>
#include <memory>
#include <string>

#include "libslam/core/pose2.h"

namespace mrpt::obs {
class CAction;
class CActionRobotMovement2D;
class CObservation;
class CObservationComment;
class CObservationOdometry;
class CObservationRobotPose;
}  // namespace mrpt::obs
namespace mrpt::poses {
class CPose2D;
class CPose3D;
}  // namespace mrpt::poses

namespace slam::objects {

inline constexpr const char* kOdometryLabel = "ODOMETRY";

/// Stamps in MRPT's ticks; kNoStamp where there is none.
std::int64_t ticksOf(const mrpt::obs::CObservation& observation);
std::int64_t ticksOf(const mrpt::obs::CAction& action);

core::Pose2 fromMrpt(const mrpt::poses::CPose2D& pose);
core::Pose2 fromMrpt(const mrpt::poses::CPose3D& pose);

/// The heading stays as it is, also when it counts whole turns.
std::shared_ptr<mrpt::obs::CObservationOdometry> makeOdometry(const core::Pose2& T_odom_robot,
                                                              std::int64_t ticks, const std::string& label);
/// Without uncertainty.
std::shared_ptr<mrpt::obs::CObservationRobotPose> makeRobotPose(const core::Pose2& pose, std::int64_t ticks,
                                                                const std::string& label);
/// A comment in a rawlog has no label.
std::shared_ptr<mrpt::obs::CObservationComment> makeComment(std::string text, std::int64_t ticks);
/// Wheel odometry with MRPT's Gaussian model and its default noise.
mrpt::obs::CActionRobotMovement2D wheelAction(const core::Pose2& T_previous_robot, std::int64_t ticks);

}  // namespace slam::objects
