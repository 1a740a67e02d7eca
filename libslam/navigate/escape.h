#pragma once
#include <functional>

#include "libslam/core/random.h"
#include "libslam/strategies/strategy.h"

namespace slam::navigate {

/// Where to of a robot whose decisions lead nowhere: a random direction of those that are seen to be free, a
/// random share of the way; where none is, a turn of a quarter at least. reach_m(direction), robot frame: how
/// far the robot can be shifted along it.
choices::Decision escapeFrom(const lidar::Scan& scan, const std::function<double(double)>& reach_m,
                             core::RandomStream& random);

}  // namespace slam::navigate
