#pragma once
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/lidar/scan.h"

namespace slam::safety {

/// Which ways are free, after the original document's CanMove: 0 both, 1 only front, 2 only rear, 3 neither.
enum class FreeWays { kBoth = 0, kFrontOnly = 1, kRearOnly = 2, kNone = 3 };

/// Front sector: beams within +-45 degrees of the heading; rear: within +-45 degrees of straight back. A way
/// is blocked when any return in its sector lies nearer than clearance_m to the robot's centre, and when the
/// lidar does not see that sector: when its readings (lost ones do not count) cover less than half of it. A
/// remembered obstacle (robot frame, see ObstacleMemory) blocks like a return.
FreeWays canMove(const lidar::Scan& scan, double clearance_m,
                 const std::vector<core::Point2>& remembered = {});

}  // namespace slam::safety
