#include "libslam/strategies/information_gain.h"

#include <cstdio>

namespace slam::strategies {
namespace {

constexpr double kCostOfDeciding_m = 1.0;
constexpr int kDirections = 120;

}  // namespace

std::optional<MapStrategy::Choice> InformationGain::choose(const Prospects& prospects) {
  Choice best;
  best.score = -1;
  for (std::size_t i = 0; i < prospects.viewpoints.size(); ++i) {
    const choices::Viewpoint& viewpoint = prospects.viewpoints[i];
    const auto profile = paths::expectedGain(prospects.space, viewpoint.p_map, prospects.view,
                                             options().unknown_path_m, kDirections);
    const double look_rad = profile.bestHeading(prospects.view);
    const double gain_m2 = profile.within(prospects.view, look_rad);
    if (gain_m2 < options().gain_min_m2) continue;
    const double score = (gain_m2 + options().view_bonus_m2) / (viewpoint.cost_m + kCostOfDeciding_m);
    if (score <= best.score) continue;
    char reason[120];
    std::snprintf(reason, sizeof reason, "best of %zu views: expects %.2f m2 of unknown for %.2f m of way",
                  prospects.viewpoints.size(), gain_m2, viewpoint.length_m);
    best = {i, score, reason, look_rad};
  }
  if (best.score < 0) return std::nullopt;
  return best;
}

}  // namespace slam::strategies
