#pragma once
#include "libslam/strategies/strategy.h"

namespace slam::strategies {

/// Keeps a wall on its right hand at wall_distance_m, by the scan alone. Until it has found a wall it drives
/// to the nearest thing in sight. Then it goes in steps of 0.3 m, each in the first direction,
/// counter-clockwise from the nearest point of the wall, in which a disc of wall_distance_m can go a step:
/// along the wall, round its end to the right, away from a corner to the left. Goes round rooms and pillars
/// in the same sense for ever; what cannot be seen on the way round is not explored.
class WallFollow : public Strategy {
 public:
  WallFollow(const StrategyOptions& options, core::RandomStream) : options_(options) {}
  choices::Decision decide(const lidar::Scan& scan, const core::Pose2& T_map_robot) override;
  bool drivesByDisc() const override { return true; }
  void setRobot(const robot::RobotOptions& robot) override { robot_ = robot; }

 private:
  StrategyOptions options_;
  robot::RobotOptions robot_;
  bool found_ = false;
};

}  // namespace slam::strategies
