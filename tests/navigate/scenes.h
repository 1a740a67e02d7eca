#pragma once
#include <cmath>
#include <vector>

#include "libslam/navigate/driver.h"
#include "libslam/sim/simulator.h"
#include "libslam/strategies/strategy.h"
#include "libslam/world/plan.h"

namespace slam::navigate::scenes {

/// width x height metres of free floor at 0.05 m, with walls two cells thick all round.
world::Plan room(double width_m, double height_m);
/// Fills the cells of the rectangle from (x0, y0) to (x1, y1), metres.
void fill(world::Plan& plan, double x0, double y0, double x1, double y1,
          world::Cell cell = world::Cell::kOccupied);
/// A flat of 12 x 8 m: a corridor, two rooms on either side behind doors of 0.9 m, a little furniture.
world::Plan flat();

/// A full circle of one-degree beams, 12 m, 1 cm noise.
lidar::LidarOptions circleLidar();

/// What a lidar without errors sees: a full circle of half-degree beams, 10 m.
lidar::Scan scanIn(const world::Plan& plan, const core::Pose2& T_world_robot, double time_s);

/// What perfect mapping makes of a drive: every cell that a ray has passed or hit, as it is in the plan.
class PerfectMap {
 public:
  explicit PerfectMap(const world::Plan& plan);
  void insert(const core::Pose2& T_world_robot, const lidar::Scan& scan);
  /// The map frame is the world.
  const gridmap::OccupancyRaster& raster() const { return raster_; }
  /// Share of the cells of the plan's floor that are connected with p_world.
  double seenShare(const core::Point2& p_world) const;

 private:
  const world::Plan& plan_;
  gridmap::OccupancyRaster raster_;
};

/// The strategies that go by the scan alone.
std::vector<std::string> maplessStrategies();

/// What a robot did and saw in a plan.
struct Exploration {
  std::vector<core::Pose2> truth;  ///< one per period, the start first
  std::vector<std::string> decisions;
  size_t collisions = 0;
  double seen_share = 0;       ///< of the free floor that is connected with the start
  double seen_share_half = 0;  ///< the same at half time
};

/// Drives for duration_s with noise on lidar and odometry.
Exploration explore(const world::Plan& plan, const core::Pose2& start,
                    const strategies::StrategyOptions& options, const lidar::LidarOptions& lidar,
                    std::uint64_t seed, double duration_s);

/// An exploration on a perfect map and with the true pose, with noise on the lidar that the driver sees.
struct MapExploration {
  bool finished = false;
  std::string end;  ///< the last decision's reason
  size_t collisions = 0;
  double time_s = 0, path_m = 0;
  double seen_share = 0;
  double path_90_m = -1, path_99_m = -1;  ///< driven when that share was seen; -1 = never
  std::vector<core::Pose2> truth;
  std::vector<choices::Decision> decisions;
};
MapExploration exploreOnMap(const world::Plan& plan, const core::Pose2& start,
                            const strategies::StrategyOptions& options, const lidar::LidarOptions& lidar,
                            std::uint64_t seed, double limit_s);

}  // namespace slam::navigate::scenes
