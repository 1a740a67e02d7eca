#include "libslam/robot/drive.h"

#include <cmath>

#include "libslam/core/elementary.h"

namespace slam::robot {

const files::ParameterTable<RobotOptions>& RobotOptions::table() {
  using O = RobotOptions;
  static const files::ParameterTable<O> rows(
      "robot", {{"side_m", &O::side_m, 0.4, 0.01, 10.0, "side of the square footprint"},
                {"max_speed_mps", &O::max_speed_mps, 0.5, 0.001, 100.0, "driving"},
                {"max_turn_rate_degps", &O::max_turn_rate_radps, 60.0, 0.1, 3600.0, "turning in place"}});
  return rows;
}

RobotOptions::RobotOptions() {
  table().setDefaults(*this);
}

double circumscribedRadius(const RobotOptions& options) {
  return options.side_m * std::sqrt(0.5);
}

Command moveCommand(const RobotOptions& options, double distance_m) {
  return {std::copysign(options.max_speed_mps, distance_m), 0.0,
          std::abs(distance_m) / options.max_speed_mps};
}

Command turnCommand(const RobotOptions& options, double angle_rad) {
  return {0.0, std::copysign(options.max_turn_rate_radps, angle_rad),
          std::abs(angle_rad) / options.max_turn_rate_radps};
}

core::Pose2 driveMotion(const Command& command) {
  return driveMotion(command, command.duration_s);
}

core::Pose2 driveMotion(const Command& command, double elapsed_s) {
  const double arc_m = command.speed_mps * elapsed_s;
  const double turn_rad = command.turn_rate_radps * elapsed_s;
  // Chord of the arc: length arc * sin(t/2) / (t/2), pointing half a turn aside. Also exact for t -> 0.
  const double half_rad = turn_rad / 2;
  const double shrink = std::abs(half_rad) < 1e-8 ? 1.0 : core::sin(half_rad) / half_rad;
  return {arc_m * shrink * core::cos(half_rad), arc_m * shrink * core::sin(half_rad),
          core::wrapToPi(turn_rad)};
}

}  // namespace slam::robot
