#include "libslam/mrptnav/mrpt_motion.h"

#include <mrpt/kinematics/CVehicleVelCmd_DiffDriven.h>

#include "libslam/core/elementary.h"
#include "libslam/lidar/mrpt_types.h"

namespace slam::mrptnav {

std::shared_ptr<mrpt::kinematics::CVehicleVelCmd_DiffDriven> toMrpt(const robot::Command& command) {
  auto speeds = std::make_shared<mrpt::kinematics::CVehicleVelCmd_DiffDriven>();
  speeds->lin_vel = command.speed_mps;
  speeds->ang_vel = command.turn_rate_radps;
  return speeds;
}

std::vector<mrpt::math::TPose2D> toMrpt(const choices::Decision& decision, const core::Pose2& T_map_robot) {
  std::vector<mrpt::math::TPose2D> poses;
  if (decision.finished) return poses;
  if (decision.path.empty()) {
    const core::Pose2 turned = T_map_robot * core::Pose2{0, 0, decision.turn_rad};
    if (decision.turn_rad != 0) poses.push_back(lidar::toMrpt(turned));
    if (decision.distance_m != 0)
      poses.push_back(lidar::toMrpt(turned * core::Pose2{decision.distance_m, 0, 0}));
    return poses;
  }
  core::Pose2 pose = T_map_robot;
  const auto lookAt = [&pose](const core::Point2& p) {
    if (p.x != pose.x || p.y != pose.y) pose.phi = core::atan2(p.y - pose.y, p.x - pose.x);
  };
  for (const auto& waypoint : decision.path) {
    lookAt(waypoint);
    pose = {waypoint.x, waypoint.y, pose.phi};
    if (&waypoint == &decision.path.back() && decision.look_at) lookAt(*decision.look_at);
    poses.push_back(lidar::toMrpt(pose));
  }
  return poses;
}

}  // namespace slam::mrptnav
