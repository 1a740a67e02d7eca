#include "libslam/strategies/wall_follow.h"

#include <algorithm>
#include <cstdio>
#include <limits>

#include "libslam/core/elementary.h"
#include "libslam/safety/safe_motion.h"
#include "libslam/safety/view.h"

namespace slam::strategies {
namespace {

constexpr double kStep_m = 0.3;
constexpr double kTurnStep_rad = core::kPi / 36;
constexpr double kRight_rad = -core::kPi / 2;

}  // namespace

choices::Decision WallFollow::decide(const lidar::Scan& scan, const core::Pose2& /*T_map_robot*/) {
  choices::Decision decision;
  decision.reason = "no valid reading";
  const auto points = lidar::scanPoints(scan);
  const auto beams = safety::seenBeams(scan);
  if (beams.empty()) return decision;
  char reason[100];
  double nearest_m = std::numeric_limits<double>::infinity(), nearest_rad = 0;
  for (const auto& p : points) {
    const double range_m = core::hypot(p.x, p.y);
    if (range_m < nearest_m) nearest_m = range_m, nearest_rad = core::atan2(p.y, p.x);
  }
  const double keep_m = std::max(options_.wall_distance_m, robot::circumscribedRadius(robot_) + 0.05);
  if (points.empty() || (!found_ && nearest_m > keep_m + kStep_m)) {
    const double range_m = points.empty() ? scan.max_range_m : nearest_m;
    decision.turn_rad = points.empty() ? 0 : nearest_rad;
    decision.distance_m = std::max(0.0, range_m - keep_m);
    std::snprintf(reason, sizeof reason, "no wall yet: towards the nearest thing, %.2f m away", range_m);
  } else {
    found_ = true;
    // Where the wall is lost on the right, this turns around its end; in a corner it turns away step by step.
    const double from_rad = nearest_m < keep_m + 2 * kStep_m ? nearest_rad : kRight_rad;
    const double near_m =
        std::min(keep_m, std::max(nearest_m - 0.02, robot::circumscribedRadius(robot_) + 0.05));
    bool free = false;
    for (double aside_rad = 0; aside_rad < 2 * core::kPi && !free; aside_rad += kTurnStep_rad) {
      const double direction_rad = from_rad + aside_rad;
      const double travel_m = safety::freeTravel(points, direction_rad, near_m);
      if (travel_m < kStep_m) continue;
      free = true;
      decision.turn_rad = core::wrapToPi(direction_rad);
      decision.distance_m = kStep_m;
    }
    decision.score = nearest_m;
    if (free)
      std::snprintf(reason, sizeof reason, "wall %.2f m away on the right: on at %.0f deg", nearest_m,
                    core::radToDeg(decision.turn_rad));
    else {
      decision.turn_rad = core::kPi / 2;
      std::snprintf(reason, sizeof reason, "no way along the wall: turn left");
    }
  }
  decision.reason = reason;
  return decision;
}

}  // namespace slam::strategies
