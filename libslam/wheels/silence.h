#pragma once
#include "libslam/core/pose2.h"

namespace slam::wheels {

/// Wheels that say nothing: a log without odometry whose form has a place for it is full of zeros. Taken as
/// odometry they hold the robot where it is.
class Silence {
 public:
  /// Whether a step of the wheels says nothing: none moved until now.
  bool take(const core::Pose2& T_wheels);
  /// The step as it was matched. True once, when by it the robot was seen to move while its wheels stood.
  bool note(const core::Pose2& T_matched);

 private:
  bool spoke_ = false, is_noted_ = false;
  core::Pose2 T_first_robot_;
};

}  // namespace slam::wheels
