#pragma once
#include <mrpt/math/TPose2D.h>

#include <memory>
#include <string>
#include <vector>

#include "libslam/robot/drive.h"
#include "libslam/strategies/strategy.h"

namespace mrpt::kinematics {
class CVehicleVelCmd_DiffDriven;
}

namespace slam::mrptnav {

/// What an MRPT robot does in the next period, and why.
struct MrptMotion {
  /// Metres and radians per second, within the robot's limits; never null. For
  /// CRobot2NavInterface::changeSpeeds() or CVehicleSimul_DiffDriven::sendVelCmd().
  std::shared_ptr<mrpt::kinematics::CVehicleVelCmd_DiffDriven> command;
  double duration_s = 0;  ///< how long it holds; call again then
  bool finished = false;  ///< the command stands still from now on
  std::string reason;     ///< "nearest frontier 3.20 m away, ..."
};

std::shared_ptr<mrpt::kinematics::CVehicleVelCmd_DiffDriven> toMrpt(const robot::Command& command);

/// A decision as poses in the map frame, to be visited in this order, for a robot that drives by its own
/// means (TWaypointSequence of CWaypointsNavigator, CAbstractPTGBasedReactive). Each pose looks along the way
/// that leads to it, the last one at what there is to be seen from there. Of a decision without a path (turn,
/// then drive straight): the turned robot, where there is a turn, then the end of the drive. Empty when the
/// exploration is finished.
std::vector<mrpt::math::TPose2D> toMrpt(const choices::Decision& decision, const core::Pose2& T_map_robot);

}  // namespace slam::mrptnav
