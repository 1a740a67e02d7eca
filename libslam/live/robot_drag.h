#pragma once
#include <optional>

#include "libslam/core/pose2.h"

namespace slam::live {

/// The robot in somebody's hand: pressed, dragged and put down by the mouse. Scene frame.
class RobotDrag {
 public:
  /// A press at p: takes hold of the robot when it is within reach_m of its centre. Returns whether it did.
  bool press(const core::Point2& p, const core::Pose2& T_scene_robot, double reach_m);
  /// The mouse is now at p. The robot moves with it; `turns`: it stays and looks there instead. Without hold
  /// nothing happens.
  void move(const core::Point2& p, bool turns);
  /// Puts it down; nullopt where it was not moved at all. Lets go of it in any case.
  std::optional<core::Pose2> release();

  /// Where it is held; nullopt: nobody holds it.
  const std::optional<core::Pose2>& held() const { return T_scene_held_; }

 private:
  std::optional<core::Pose2> T_scene_held_;
  core::Point2 from_mouse_;  ///< the robot's centre
  bool is_moved_ = false;
};

}  // namespace slam::live
