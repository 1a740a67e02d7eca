#include "libslam/logs/action_increment.h"

#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CActionRobotMovement3D.h>

namespace slam::logs {
namespace {

core::Pose2 fromMrptPose(const mrpt::poses::CPose2D& pose) {
  return {pose.x(), pose.y(), pose.phi()};
}

}  // namespace

std::optional<core::Pose2> incrementOf(const mrpt::obs::CActionCollection& actions) {
  using mrpt::obs::CActionRobotMovement2D;
  std::optional<core::Pose2> matched, spatial;
  for (const auto& action : actions) {
    if (const auto* planar = dynamic_cast<const CActionRobotMovement2D*>(action.get())) {
      if (planar->estimationMethod == CActionRobotMovement2D::emOdometry)
        return fromMrptPose(planar->rawOdometryIncrementReading);
      if (!matched && planar->poseChange) matched = fromMrptPose(planar->poseChange->getMeanVal());
    } else if (const auto* full = dynamic_cast<const mrpt::obs::CActionRobotMovement3D*>(action.get())) {
      const auto& mean = full->poseChange.mean;
      if (!spatial) spatial = core::Pose2{mean.x(), mean.y(), mean.yaw()};
    }
  }
  return matched ? matched : spatial;
}

}  // namespace slam::logs
