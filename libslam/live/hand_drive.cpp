#include "libslam/live/hand_drive.h"

namespace slam::live {

robot::Command commandOf(const HeldKeys& keys, const robot::RobotOptions& robot, double period_s) {
  const int along = int{keys.ahead} - int{keys.back}, turn = int{keys.left} - int{keys.right};
  robot::Command command;
  command.speed_mps = along * keys.share * robot.max_speed_mps;
  command.turn_rate_radps = turn * keys.share * robot.max_turn_rate_radps;
  command.duration_s = period_s;
  return command;
}

}  // namespace slam::live
