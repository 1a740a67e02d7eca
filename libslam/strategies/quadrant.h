#pragma once
#include <optional>

#include "libslam/strategies/strategy.h"

namespace slam::strategies {

/// The original improvement: the view is split into four quadrants around the heading (front-left, rear-left,
/// rear-right, front-right), the longest ray of each is a candidate, and a candidate that leads back the way
/// the robot came (within 45 degrees of the direction to where the last drive began, by odometry) is not
/// chosen. Of the others the longest wins; the drive is as LongestRay's. Where no other candidate is longer
/// than the stop clearance, a dead end, the way back is taken after all.
class Quadrant : public Strategy {
 public:
  Quadrant(const StrategyOptions& options, core::RandomStream random) : options_(options), random_(random) {}
  choices::Decision decide(const lidar::Scan& scan, const core::Pose2& T_odom_robot) override;
  void setStopClearance(double clearance_m) override { options_.stop_clearance_m = clearance_m; }

 private:
  void rememberWay(const core::Pose2& T_odom_robot);
  bool leadsBack(double angle_rad, const core::Pose2& T_odom_robot) const;

  StrategyOptions options_;
  core::RandomStream random_;
  std::optional<core::Pose2> T_odom_here_;  ///< place of the newest decision
  std::optional<core::Pose2> T_odom_from_;  ///< place of the decision that led here
};

}  // namespace slam::strategies
