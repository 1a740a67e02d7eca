#include "libslam/live/robot_drag.h"

#include "libslam/core/elementary.h"

namespace slam::live {

bool RobotDrag::press(const core::Point2& p, const core::Pose2& T_scene_robot, double reach_m) {
  if (core::distance(p, core::position(T_scene_robot)) > reach_m) return false;
  T_scene_held_ = T_scene_robot;
  from_mouse_ = {T_scene_robot.x - p.x, T_scene_robot.y - p.y};
  is_moved_ = false;
  return true;
}

void RobotDrag::move(const core::Point2& p, bool turns) {
  if (!T_scene_held_) return;
  auto& held = *T_scene_held_;
  is_moved_ = true;
  if (turns) {
    held.phi = core::atan2(p.y - held.y, p.x - held.x);
    from_mouse_ = {held.x - p.x, held.y - p.y};
  } else {
    held.x = p.x + from_mouse_.x;
    held.y = p.y + from_mouse_.y;
  }
}

std::optional<core::Pose2> RobotDrag::release() {
  const auto put_down = is_moved_ ? T_scene_held_ : std::nullopt;
  T_scene_held_.reset();
  return put_down;
}

}  // namespace slam::live
