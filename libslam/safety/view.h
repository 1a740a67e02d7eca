#pragma once
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/lidar/scan.h"

namespace slam::safety {

/// One direction that the lidar reports on.
struct SeenBeam {
  double angle_rad;  ///< in the robot frame, in [0, 2 pi): 0 straight ahead, counter-clockwise
  double range_m;    ///< from the lidar; the maximum range where nothing returned
};

/// The beams in the order of the original documents: from straight ahead once round in one turning direction.
/// Lost readings are left out; directions outside the field of view are simply not there.
std::vector<SeenBeam> seenBeams(const lidar::Scan& scan);

/// How far a disc of radius_m around the robot's centre can be shifted straight along direction_rad (robot
/// frame) until it touches one of the points: 0 when it already does and would go on into it, +infinity when
/// no point is in the way. Says nothing of what no beam saw.
double freeTravel(const std::vector<core::Point2>& points_robot, double direction_rad, double radius_m);

/// 0..3: front-left, rear-left, rear-right, front-right, 90 degrees each, for an angle in [0, 2 pi).
int quadrantOf(double angle_rad);

}  // namespace slam::safety
