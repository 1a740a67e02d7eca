#pragma once
#include "libslam/files/parameters.h"

namespace slam::methods {

/// Section [motion], types rbpf and particles: MRPT's Gaussian motion model. The standard deviations of an
/// increment of length d (metres) and turn a (radians, absolute) are
///   x, y: sigma_xy_m + sigma_xy_per_m * d + sigma_xy_per_rad * a
///   phi:  sigma_turn + sigma_turn_per_m * d + sigma_turn_per_rad * a
/// (CActionRobotMovement2D, mmGaussian). For increments of the wheels; those estimated from scans bring their
/// own spread.
struct MotionOptions {
  double sigma_xy_m, sigma_xy_per_m, sigma_xy_per_rad;
  double sigma_turn_rad, sigma_turn_per_m_rad, sigma_turn_per_rad;
  MotionOptions();
  static const files::ParameterTable<MotionOptions>& table();
};

}  // namespace slam::methods
