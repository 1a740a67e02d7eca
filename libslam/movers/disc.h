#pragma once
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::movers {

/// A round thing: a leg, a person, the robot's footprint.
struct Disc {
  core::Point2 p;
  double radius_m = 0;
};

/// Metres along a unit vector to the disc's rim: 0 from within, +infinity where the ray misses it. The same
/// frame for all. Exact but for rounding.
double castRay(const Disc& disc, const core::Point2& origin, const core::Point2& direction);

/// Puts discs in front of a cast scan: shortens the ranges of beams that meet one nearer than what they have,
/// up to max_range_m (<= 0: no limit). Beams as rays::castScan() has them, one per element of `ranges_m`.
/// Only the beams within a disc's bearing are looked at. A pose that is not finite changes nothing.
void castScan(const std::vector<Disc>& discs, const core::Pose2& T_world_lidar, double first_angle_rad,
              double step_rad, double max_range_m, std::vector<float>& ranges_m);

}  // namespace slam::movers
