#include "libslam/strategies/random_heading.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "libslam/safety/view.h"

namespace slam::strategies {

choices::Decision RandomHeading::decide(const lidar::Scan& scan, const core::Pose2& /*T_map_robot*/) {
  // Drawn whatever the scan holds, so that one empty scan does not shift the later draws.
  const double divisor = random_.uniform(options_.divisor_min, options_.divisor_max);
  const double pick = random_.uniform(), turn = random_.uniform(-1, 1);
  auto beams = safety::seenBeams(scan);
  choices::Decision decision;
  decision.reason = "no valid reading";
  if (beams.empty()) return decision;
  beams.erase(
      std::remove_if(beams.begin(), beams.end(),
                     [&](const safety::SeenBeam& b) { return b.range_m <= options_.stop_clearance_m; }),
      beams.end());
  char reason[80];
  if (beams.empty()) {
    decision.turn_rad = core::kPi / 2 * (turn + (turn < 0 ? -1 : 1));
    std::snprintf(reason, sizeof reason, "nothing free in sight: turn by %.0f deg",
                  core::radToDeg(decision.turn_rad));
  } else {
    const auto& beam = beams[static_cast<std::size_t>(pick * static_cast<double>(beams.size()))];
    decision.turn_rad = core::wrapToPi(beam.angle_rad);
    decision.distance_m = beam.range_m / divisor;
    decision.score = beam.range_m;
    decision.ray_m = beam.range_m;
    std::snprintf(reason, sizeof reason, "random direction %.0f deg, free for %.2f m",
                  core::radToDeg(decision.turn_rad), beam.range_m);
  }
  decision.reason = reason;
  return decision;
}

}  // namespace slam::strategies
