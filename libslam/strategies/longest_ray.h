#pragma once
#include "libslam/strategies/strategy.h"

namespace slam::strategies {

/// The original strategy: turn to the longest ray and drive (its length / u), u uniform between the two
/// divisors. A ray without return counts as the maximum range; of equal rays the first counter-clockwise from
/// straight ahead wins. It drives straight and stops before what is in the way, or, with `ray_navigator`,
/// goes round it to the ray's end (see Driver). It soon shuttles along the longest diagonal of a room: kept
/// so, for comparison.
class LongestRay : public Strategy {
 public:
  LongestRay(const StrategyOptions& options, core::RandomStream random)
      : options_(options), random_(random) {}
  choices::Decision decide(const lidar::Scan& scan, const core::Pose2& T_odom_robot) override;

 private:
  StrategyOptions options_;
  core::RandomStream random_;
};

}  // namespace slam::strategies
