#pragma once
#include <vector>

#include "libslam/lidar/scan.h"

namespace slam::odometry {

/// As many beams, in the same directions to a thousandth of a step.
bool sameBeams(const lidar::Scan& a, const lidar::Scan& b);

/// A turn under which two range profiles look alike.
struct TurnCandidate {
  double turn_rad = 0;     ///< of the lidar, counter-clockwise positive, to a fraction of a beam
  double correlation = 0;  ///< Pearson's r over the beams that both scans have, -1 .. 1
};

/// Circular cross-correlation of the two range profiles over turns up to max_turn_rad either way: the highest
/// peaks, at most `count`, best first (of equal ones the smaller turn), no two within 5 degrees. A peak is
/// placed between beams by the parabola through its three values. Over a partial field of view only the
/// overlap counts, and at least a third of the beams must overlap. Ranges enter by their logarithm, so that
/// one far wall does not outweigh everything near; a no-return counts as max_range_m, a lost reading not at
/// all. Empty when the profile has no shape (a round room) or too few readings. A scan of other geometry than
/// `after` is resampled to the beams of `after`, nearest beam. Cost: beams times turns.
std::vector<TurnCandidate> correlateProfiles(const lidar::Scan& before, const lidar::Scan& after,
                                             double max_turn_rad, size_t count);

}  // namespace slam::odometry
