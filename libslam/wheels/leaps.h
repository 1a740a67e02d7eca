#pragma once
#include "libslam/core/pose2.h"

namespace slam::wheels {

/// Steps of odometry that no driving made: the counter began anew, or somebody set its pose. A leap is longer
/// than what two scans share and faster than indoor robots are and than the wheels ever were. Two in a row
/// are a vehicle that is fast.
class Leaps {
 public:
  /// Whether a step (m; whatever it turned) is a leap, and learns from it. `since_s`: since the step before;
  /// not positive or not finite: the step is none.
  bool take(const core::Pose2& T_wheels, double since_s);

 private:
  double fastest_mps_ = 0;
  bool leapt_ = false;  ///< in the step before
};

}  // namespace slam::wheels
