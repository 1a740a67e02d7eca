#include "libslam/navigate/safe_motion.h"

#include <algorithm>
#include <cmath>

#include "libslam/navigate/strategy.h"
#include "libslam/navigate/view.h"

namespace slam::navigate {

double discReach(const robot::Scan& scan, double direction_rad, const robot::RobotOptions& robot) {
  // The nearest of many noisy readings already lies some standard deviations before the wall.
  const double margin_m = 0.02 + scan.range_sigma_m;
  return freeTravel(robot::scanPoints(scan), direction_rad, robot::circumscribedRadius(robot) + margin_m);
}

bool seesAhead(const robot::Scan& scan) {
  const FreeWays ways = canMove(scan, 0);
  return ways == FreeWays::kBoth || ways == FreeWays::kFrontOnly;
}

double safeSpeed(const robot::Scan& scan, const robot::RobotOptions& robot, double slow_clearance_m) {
  double nearest_m = robot::circumscribedRadius(robot) + slow_clearance_m;
  for (const auto& p : robot::scanPoints(scan)) nearest_m = std::min(nearest_m, std::hypot(p.x, p.y));
  const double gap_m = std::max(0.0, nearest_m - robot::circumscribedRadius(robot));
  return robot.max_speed_mps * (slow_clearance_m > 0 ? 0.4 + 0.6 * gap_m / slow_clearance_m : 1.0);
}

}  // namespace slam::navigate
