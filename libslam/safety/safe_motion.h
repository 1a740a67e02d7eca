#pragma once
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/lidar/scan.h"
#include "libslam/robot/drive.h"

namespace slam::safety {

/// How far the disc around the square footprint, with a margin of 2 cm and one standard deviation of the
/// range, can be shifted straight along direction_rad (robot frame) by the returns of this scan; +infinity
/// when none is in the way. `remembered` are further obstacles, robot frame: see ObstacleMemory. Says nothing
/// of what no beam saw: see seesAhead().
double discReach(const lidar::Scan& scan, double direction_rad, const robot::RobotOptions& robot,
                 const std::vector<core::Point2>& remembered = {});

/// True when the readings (lost ones do not count) cover at least half of the front sector of canMove().
bool seesAhead(const lidar::Scan& scan);

/// The largest speed near to obstacles: max_speed_mps where every return is at least slow_clearance_m away
/// from the disc, falling linearly with the gap to 0.4 of it at the disc.
double safeSpeed(const lidar::Scan& scan, const robot::RobotOptions& robot, double slow_clearance_m,
                 const std::vector<core::Point2>& remembered = {});

/// The distance threshold w of canMove() that follows from the robot: R + s + m, with R the circle around the
/// footprint, s the longest step of one period (max_speed_mps * period_s) and m the margin that discReach()
/// keeps, 2 cm and one standard deviation of the range. With every range of the sector at least w, the robot
/// can drive one whole step along any direction of the sector, and at its end the circle still has its
/// margin; so it stops in time when it asks once per period. The default robot, 5 scans per second, sigma 1
/// cm: 0.413 m.
double stopClearance(const robot::RobotOptions& robot, double period_s, double range_sigma_m);

}  // namespace slam::safety
