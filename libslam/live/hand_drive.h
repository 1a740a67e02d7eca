#pragma once
#include "libslam/robot/drive.h"

namespace slam::live {

/// The keys that are down, and how fast they are to drive.
struct HeldKeys {
  bool ahead = false, back = false, left = false, right = false;
  double share = 0.5;  ///< of the robot's full speed, 0..1
};

/// What they ask of the robot for one period: that share of its full speed ahead or back, and of its full turn rate, left
/// counter-clockwise; opposite keys cancel.
robot::Command commandOf(const HeldKeys& keys, const robot::RobotOptions& robot, double period_s);

}  // namespace slam::live
