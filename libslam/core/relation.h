#pragma once
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::core {

/// What somebody knows of the motion between two moments: the robot's pose at to_time_s seen from that at
/// from_time_s. Two such moments may be in any order, and far apart: a place seen again.
struct Relation {
  double from_time_s = 0, to_time_s = 0;  ///< seconds, as the log's stamps
  Pose2 T_from_to;
};
using Relations = std::vector<Relation>;

}  // namespace slam::core
