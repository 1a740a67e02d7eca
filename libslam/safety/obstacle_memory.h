#pragma once
#include <memory>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/lidar/scan.h"
#include "libslam/obstacles/local_obstacle_map.h"

namespace slam::safety {

/// What the robot keeps in mind, for motion, of the obstacles that its newest scan does not show.
///   none       nothing: the newest scan alone
///   short      what earlier scans showed within 1.5 m outside of the newest one's angle of view: it forgets
///              whatever lies in that angle, also behind an obstacle
///   local_map  the original local obstacle map, obstacles::LocalObstacleMap, with the zone of [obstacles]:
///              the visible area is where the scan sees the floor, so what lies hidden or in the dead zone
///              stays. Returns outside the zone are not put in, and of those in it one per cell of the merge
///              distance, so that max_points are points worth keeping
/// Both memories trust the pose between two scans only.
class ObstacleMemory {
 public:
  virtual ~ObstacleMemory() = default;
  /// The newest scan, taken at T_odom_robot (in any frame that stays put). Cost: the beams and the points.
  virtual void update(const lidar::Scan& scan, const core::Pose2& T_odom_robot) = 0;
  /// After the newest update, robot frame. None of the newest scan's own returns.
  virtual std::vector<core::Point2> points() const = 0;
};

/// REQUIRES a name of obstacleMemoryNames() (ContractError).
std::unique_ptr<ObstacleMemory> makeObstacleMemory(const std::string& name,
                                                   const obstacles::LocalObstacleOptions& zone);
const std::vector<std::string>& obstacleMemoryNames();

}  // namespace slam::safety
