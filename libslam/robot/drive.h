#pragma once
#include "libslam/core/pose2.h"
#include "libslam/files/parameters.h"

namespace slam::robot {

/// One command to a differential drive: constant speeds for a while. The original commands move(step) and
/// turn(angle) are the two special cases; moveCommand and turnCommand make them.
struct Command {
  double speed_mps = 0;        ///< along the heading; negative backs off
  double turn_rate_radps = 0;  ///< counter-clockwise positive
  double duration_s = 0;
};

/// Square body and limits; section [robot].
struct RobotOptions {
  double side_m;  ///< of the square footprint
  double max_speed_mps;
  double max_turn_rate_radps;
  RobotOptions();
  static const files::ParameterTable<RobotOptions>& table();
};

/// Radius of the circle around the square: it must stay free so that the robot can turn in place.
double circumscribedRadius(const RobotOptions& options);

/// Drives `distance_m` (negative: backwards) at most at full speed.
Command moveCommand(const RobotOptions& options, double distance_m);
/// Turns in place by `angle_rad`.
Command turnCommand(const RobotOptions& options, double angle_rad);

/// Exact motion of a differential drive under a command, from the start of the command: an arc or a straight
/// line, or a turn in place. T_start_end.
core::Pose2 driveMotion(const Command& command);
/// The same after only `elapsed_s` of it.
core::Pose2 driveMotion(const Command& command, double elapsed_s);

}  // namespace slam::robot
