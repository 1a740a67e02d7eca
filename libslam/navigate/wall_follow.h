#pragma once
#include "libslam/navigate/strategy.h"

namespace slam::navigate {

/// Keeps a wall on its right hand at wall_distance_m, by the scan alone. Until it has found a wall it drives to
/// the nearest thing in sight. Then, in steps of at most half a metre: to the left where the way ahead is
/// blocked, to the right where the wall on the right ends, else along the wall, turned a little to or from it
/// by how far the distance is off. Goes round every room and every pillar in the same sense; what is neither
/// is not explored.
class WallFollow : public Strategy {
 public:
  WallFollow(const StrategyOptions& options, core::RandomStream) : options_(options) {}
  Decision decide(const robot::Scan& scan, const core::Pose2& T_map_robot) override;
  bool drivesByDisc() const override { return true; }
  void setRobot(const robot::RobotOptions& robot) override { robot_ = robot; }

 private:
  StrategyOptions options_;
  robot::RobotOptions robot_;
  bool found_ = false;
};

}  // namespace slam::navigate
