#include "libslam/live/drive_seat.h"

namespace slam::live {

DriveSeat::DriveSeat(const robot::RobotOptions& robot, double period_s,
                     const std::vector<robot::UserCommand>& commands, Stage* stage, bool ends)
    : robot_(robot),
      hand_(robot, period_s),
      commands_(commands.begin(), commands.end()),
      stage_(stage),
      ends_(ends || stage == nullptr) {}

std::optional<run::Order> DriveSeat::next(bool collided) {
  if (stage_ && stage_->isClosed()) return std::nullopt;
  std::optional<robot::UserCommand> command;
  if (!commands_.empty()) {
    command = commands_.front();
    commands_.pop_front();
  } else if (ends_) {
    return std::nullopt;
  } else {
    command = stage_->takeCommand();
  }
  run::Order order = command ? robot::toCommand(*command, robot_) : hand_.next(stage_->keys(), collided);
  if (stage_) order.T_world_carried = stage_->takeCarry();
  return order;
}

}  // namespace slam::live
