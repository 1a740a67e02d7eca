#pragma once
#include "libslam/strategies/strategy.h"

namespace slam::strategies {

/// The least that any other has to beat: turn to a direction drawn evenly from the beams that are longer than
/// stop_clearance_m and drive (its length / u), u uniform between the two divisors. Where no beam is that
/// long, turn round by at least a quarter.
class RandomHeading : public Strategy {
 public:
  RandomHeading(const StrategyOptions& options, core::RandomStream random)
      : options_(options), random_(random) {}
  choices::Decision decide(const lidar::Scan& scan, const core::Pose2& T_map_robot) override;
  void setStopClearance(double clearance_m) override { options_.stop_clearance_m = clearance_m; }

 private:
  StrategyOptions options_;
  core::RandomStream random_;
};

}  // namespace slam::strategies
