#pragma once
#include "libslam/core/parameters.h"
#include "libslam/core/pose2.h"
#include "libslam/core/random.h"

namespace slam::robot {

/// Errors of wheel odometry; section [odometry].
struct OdometryOptions {
  double alpha1, alpha2, alpha3,
      alpha4;                 ///< Thrun, Burgard and Fox, Probabilistic Robotics (2005), table 5.6
  double scale;               ///< systematic: reported over true distance
  double heading_bias_radpm;  ///< systematic: heading reported too large per metre driven
  OdometryOptions();
  static const core::ParameterTable<OdometryOptions>& table();
};

/// What the wheels report for a true increment T_before_after: decomposed into turn, drive, turn, each with
/// noise of variance alpha1 rot^2 + alpha2 trans^2 and so on (Probabilistic Robotics, table 5.6), then the
/// systematic errors. A backward drive is decomposed as a backward drive, not as two half turns.
core::Pose2 sampleOdometry(const core::Pose2& T_before_after, const OdometryOptions& options,
                           core::RandomStream& random);

}  // namespace slam::robot
