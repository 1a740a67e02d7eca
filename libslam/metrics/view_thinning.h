#pragma once
#include <cmath>

#include "libslam/core/pose2.h"

namespace slam::metrics {

/// Views from nearly one place tell the same: a pose within 0.1 m and 5 degrees of the last one used is
/// passed over.
inline bool isNewView(const core::Pose2& last_used, const core::Pose2& pose) {
  constexpr double kThinDistance_m = 0.1;
  constexpr double kThinAngle_rad = core::degToRad(5);
  return core::distance(last_used, pose) > kThinDistance_m ||
         std::abs(core::angleDifference(last_used.phi, pose.phi)) > kThinAngle_rad;
}

}  // namespace slam::metrics
