#include "libslam/safety/safe_motion.h"

#include <algorithm>

#include "libslam/core/elementary.h"
#include "libslam/safety/free_ways.h"
#include "libslam/safety/view.h"

namespace slam::safety {
namespace {
constexpr double kMargin_m = 0.02;
}

double discReach(const lidar::Scan& scan, double direction_rad, const robot::RobotOptions& robot,
                 const std::vector<core::Point2>& remembered) {
  // The nearest of many noisy readings already lies some standard deviations before the wall.
  const double margin_m = kMargin_m + scan.range_sigma_m;
  const double radius_m = robot::circumscribedRadius(robot) + margin_m;
  return std::min(freeTravel(lidar::scanPoints(scan), direction_rad, radius_m),
                  freeTravel(remembered, direction_rad, radius_m));
}

double stopClearance(const robot::RobotOptions& robot, double period_s, double range_sigma_m) {
  return robot::circumscribedRadius(robot) + robot.max_speed_mps * period_s + kMargin_m + range_sigma_m;
}

bool seesAhead(const lidar::Scan& scan) {
  const FreeWays ways = canMove(scan, 0);
  return ways == FreeWays::kBoth || ways == FreeWays::kFrontOnly;
}

double safeSpeed(const lidar::Scan& scan, const robot::RobotOptions& robot, double slow_clearance_m,
                 const std::vector<core::Point2>& remembered) {
  double nearest_m = robot::circumscribedRadius(robot) + slow_clearance_m;
  for (const auto& p : lidar::scanPoints(scan)) nearest_m = std::min(nearest_m, core::hypot(p.x, p.y));
  for (const auto& p : remembered) nearest_m = std::min(nearest_m, core::hypot(p.x, p.y));
  const double gap_m = std::max(0.0, nearest_m - robot::circumscribedRadius(robot));
  return robot.max_speed_mps * (slow_clearance_m > 0 ? 0.4 + 0.6 * gap_m / slow_clearance_m : 1.0);
}

}  // namespace slam::safety
