#pragma once
#include <optional>

#include "libslam/paths/free_space.h"
#include "libslam/strategies/strategy.h"

namespace slam::navigate {

/// Drives to the origin of the map, where the first scan was taken, along the shortest way through what the
/// map calls free; finished there, or when the map knows no way. Knows no more than any other strategy.
class ReturnToStart : public strategies::Strategy {
 public:
  ReturnToStart(const strategies::StrategyOptions& options, const robot::RobotOptions& robot)
      : options_(options), robot_(robot) {}
  choices::Decision decide(const lidar::Scan& scan, const core::Pose2& T_map_robot) override;
  bool needsMap() const override { return true; }
  void seeMap(const gridmap::OccupancyRaster& map) override { space_ = paths::readFreeSpace(map); }
  bool drivesByDisc() const override { return true; }

 private:
  strategies::StrategyOptions options_;
  robot::RobotOptions robot_;
  std::optional<paths::FreeSpace> space_;
};
/// This near it is back.
inline constexpr double kBackAtStart_m = 0.3;

}  // namespace slam::navigate
