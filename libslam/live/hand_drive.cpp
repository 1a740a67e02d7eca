#include "libslam/live/hand_drive.h"

namespace slam::live {

robot::Command HandDrive::next(const HeldKeys& keys, bool collided) {
  const int asked = int{keys.ahead} - int{keys.back}, turn = int{keys.left} - int{keys.right};
  if (collided && along_ != 0) blocked_ = along_;
  if (asked != blocked_) blocked_ = 0;
  along_ = blocked_ == 0 ? asked : 0;
  robot::Command command;
  command.speed_mps = along_ * keys.share * robot_.max_speed_mps;
  command.turn_rate_radps = turn * keys.share * robot_.max_turn_rate_radps;
  command.duration_s = period_s_;
  return command;
}

}  // namespace slam::live
