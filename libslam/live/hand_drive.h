#pragma once
#include "libslam/robot/drive.h"

namespace slam::live {

/// The keys that are down, and how fast they are to drive.
struct HeldKeys {
  bool ahead = false, back = false, left = false, right = false;
  double share = 0.5;  ///< of the robot's full speed, 0..1
};

/// Someone at the keys, period by period.
class HandDrive {
 public:
  HandDrive(const robot::RobotOptions& robot, double period_s) : robot_(robot), period_s_(period_s) {}

  /// What the keys ask for: their share of full speed ahead or back, and of the full turn rate, left
  /// counter-clockwise; opposite keys cancel. `collided`: the last command ended at an obstacle. Then the
  /// robot stays, though it may turn, until the key that drove it there is let go: to push on against a wall
  /// is no new collision.
  robot::Command next(const HeldKeys& keys, bool collided);

 private:
  robot::RobotOptions robot_;
  double period_s_;
  int along_ = 0;    ///< 1 ahead, -1 back, of the last command
  int blocked_ = 0;  ///< which way there is something
};

}  // namespace slam::live
