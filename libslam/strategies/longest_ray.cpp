#include "libslam/strategies/longest_ray.h"

#include <cmath>
#include <cstdio>

#include "libslam/safety/view.h"

namespace slam::strategies {

choices::Decision LongestRay::decide(const lidar::Scan& scan, const core::Pose2& /*T_odom_robot*/) {
  // Drawn whatever the scan holds, so that one empty scan does not shift the later draws.
  const double divisor = random_.uniform(options_.divisor_min, options_.divisor_max);
  const auto beams = safety::seenBeams(scan);
  choices::Decision decision;
  decision.reason = "no valid reading";
  if (beams.empty()) return decision;
  safety::SeenBeam longest = beams.front();
  for (const auto& beam : beams)
    if (beam.range_m > longest.range_m) longest = beam;

  decision.turn_rad = core::wrapToPi(longest.angle_rad);
  decision.distance_m = longest.range_m / divisor;
  decision.score = longest.range_m;
  decision.ray_m = longest.range_m;
  char reason[80];
  std::snprintf(reason, sizeof reason, "longest ray %.2f m at %.0f deg", longest.range_m,
                core::radToDeg(decision.turn_rad));
  decision.reason = reason;
  return decision;
}

}  // namespace slam::strategies
