#include "libslam/navigate/escape.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "libslam/safety/view.h"

namespace slam::navigate {
namespace {

constexpr double kShortestEscape_m = 0.2;
constexpr double kEscapeStep_rad = core::kPi / 36;

}  // namespace

choices::Decision escapeFrom(const lidar::Scan& scan, const std::function<double(double)>& reach_m,
                             core::RandomStream& random) {
  struct Way {
    double angle_rad, reach_m;
  };
  std::vector<Way> ways;
  double last_rad = -core::kPi;
  for (const auto& beam : safety::seenBeams(scan)) {
    if (beam.angle_rad - last_rad < kEscapeStep_rad) continue;
    last_rad = beam.angle_rad;
    const double free_m = std::min(beam.range_m, reach_m(beam.angle_rad));
    if (free_m >= kShortestEscape_m) ways.push_back({beam.angle_rad, free_m});
  }
  choices::Decision chosen;
  char reason[80];
  if (ways.empty()) {
    // Nothing that is seen is free: look elsewhere, at least a quarter turn away.
    const int sign = random.chance(0.5) ? 1 : -1;
    chosen.turn_rad = sign * random.uniform(core::kPi / 2, core::kPi);
    std::snprintf(reason, sizeof reason, "stuck: look around by %.0f deg", core::radToDeg(chosen.turn_rad));
  } else {
    const Way& way = ways[random.below(ways.size())];
    chosen.turn_rad = core::wrapToPi(way.angle_rad);
    chosen.distance_m = std::max(kShortestEscape_m, way.reach_m * random.uniform(0.5, 1.0));
    chosen.score = way.reach_m;
    std::snprintf(reason, sizeof reason, "stuck: random free direction at %.0f deg",
                  core::radToDeg(chosen.turn_rad));
  }
  chosen.reason = reason;
  return chosen;
}

}  // namespace slam::navigate
