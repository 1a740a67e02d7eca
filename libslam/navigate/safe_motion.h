#pragma once
#include "libslam/robot/drive.h"
#include "libslam/robot/scan.h"

namespace slam::navigate {

/// How far the disc around the square footprint, with a margin of 2 cm and one standard deviation of the
/// range, can be shifted straight along direction_rad (robot frame) by the returns of this scan; +infinity
/// when none is in the way. Says nothing of what no beam saw: see seesAhead().
double discReach(const robot::Scan& scan, double direction_rad, const robot::RobotOptions& robot);

/// True when the readings (lost ones do not count) cover at least half of the front sector of canMove().
bool seesAhead(const robot::Scan& scan);

/// The largest speed near to obstacles: max_speed_mps where every return is at least slow_clearance_m away
/// from the disc, falling linearly with the gap to 0.4 of it at the disc.
double safeSpeed(const robot::Scan& scan, const robot::RobotOptions& robot, double slow_clearance_m);

}  // namespace slam::navigate
