#include "libslam/live/drive_seat.h"

namespace slam::live {

DriveSeat::DriveSeat(const robot::RobotOptions& robot, double period_s,
                     const std::vector<robot::UserCommand>& commands, Stage* stage, bool ends)
    : robot_(robot),
      hand_(robot, period_s),
      commands_(commands.begin(), commands.end()),
      stage_(stage),
      ends_(ends || stage == nullptr) {}

std::optional<record::Order> DriveSeat::next(bool collided) {
  const bool is_closed = stage_ && stage_->isClosed();
  const auto T_world_carried = stage_ ? stage_->takeCarry() : std::nullopt;
  std::optional<robot::UserCommand> command;
  if (!commands_.empty() && !is_closed) {
    command = commands_.front();
    commands_.pop_front();
  } else if (stage_) {
    command = stage_->takeCommand();
  }
  const bool is_over = is_closed || (ends_ && commands_.empty());
  if (!command && !T_world_carried && is_over) return std::nullopt;
  HeldKeys keys;
  if (stage_ && !is_over) keys = stage_->keys();
  record::Order order(command ? robot::toCommand(*command, robot_) : hand_.next(keys, collided),
                      command.has_value());
  order.T_world_carried = T_world_carried;
  return order;
}

}  // namespace slam::live
