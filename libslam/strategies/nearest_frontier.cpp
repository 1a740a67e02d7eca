#include "libslam/strategies/nearest_frontier.h"

#include <cstdio>

namespace slam::strategies {

std::optional<MapStrategy::Choice> NearestFrontier::choose(const Prospects& prospects) {
  const choices::Viewpoint& nearest = prospects.viewpoints.front();
  char reason[120];
  std::snprintf(
      reason, sizeof reason, "nearest of %zu frontiers: %.2f m away, %.2f m long", prospects.frontiers.size(),
      nearest.length_m,
      static_cast<double>(prospects.frontiers[nearest.frontier].cells.size()) * prospects.space.resolution_m);
  return Choice{0, -nearest.cost_m, reason, std::nullopt};
}

}  // namespace slam::strategies
