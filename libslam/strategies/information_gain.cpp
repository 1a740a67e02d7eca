#include "libslam/strategies/information_gain.h"

#include <cstdio>

namespace slam::strategies {
namespace {

constexpr double kCostOfDeciding_m = 1.0;
constexpr int kDirections = 120;

}  // namespace

std::optional<MapStrategy::Choice> InformationGain::choose(const Scene& scene) {
  Choice best;
  best.score = -1;
  for (std::size_t i = 0; i < scene.viewpoints.size(); ++i) {
    const choices::Viewpoint& viewpoint = scene.viewpoints[i];
    const auto profile =
        paths::expectedGain(scene.space, viewpoint.p_map, scene.view, options().unknown_path_m, kDirections);
    const double look_rad = profile.bestHeading(scene.view);
    const double gain_m2 = profile.within(scene.view, look_rad);
    if (gain_m2 < options().gain_min_m2) continue;
    const double score = (gain_m2 + options().view_bonus_m2) / (viewpoint.cost_m + kCostOfDeciding_m);
    if (score <= best.score) continue;
    char reason[120];
    std::snprintf(reason, sizeof reason, "best of %zu views: expects %.2f m2 of unknown for %.2f m of way",
                  scene.viewpoints.size(), gain_m2, viewpoint.length_m);
    best = {i, score, reason, look_rad};
  }
  if (best.score < 0) return std::nullopt;
  return best;
}

}  // namespace slam::strategies
