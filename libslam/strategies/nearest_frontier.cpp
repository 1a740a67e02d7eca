#include "libslam/strategies/nearest_frontier.h"

#include <cstdio>

namespace slam::strategies {

std::optional<MapStrategy::Choice> NearestFrontier::choose(const Scene& scene) {
  const choices::Viewpoint& nearest = scene.viewpoints.front();
  char reason[120];
  std::snprintf(
      reason, sizeof reason, "nearest of %zu frontiers: %.2f m away, %.2f m long", scene.frontiers.size(),
      nearest.length_m,
      static_cast<double>(scene.frontiers[nearest.frontier].cells.size()) * scene.space.resolution_m);
  return Choice{0, -nearest.cost_m, reason, std::nullopt};
}

}  // namespace slam::strategies
