#pragma once
#include <cstdio>

#include "libslam/strategies/map_strategy.h"

namespace slam::strategies {

/// Drives to the frontier that is nearest by the way there, wherever it is and however large (Yamauchi, "A
/// frontier-based approach for autonomous exploration", CIRA 1997). The score is minus the cost of the way.
class NearestFrontier : public MapStrategy {
 public:
  NearestFrontier(const StrategyOptions& options, core::RandomStream) : MapStrategy(options) {}

 private:
  std::optional<Choice> choose(const Prospects& prospects) override {
    const choices::Viewpoint& nearest = prospects.viewpoints.front();
    char reason[120];
    std::snprintf(reason, sizeof reason, "nearest of %zu frontiers: %.2f m away, %.2f m long",
                  prospects.frontiers.size(), nearest.length_m,
                  static_cast<double>(prospects.frontiers[nearest.frontier].cells.size()) *
                      prospects.space.resolution_m);
    return Choice{0, -nearest.cost_m, reason, std::nullopt};
  }
  bool wantsStandoffs() const override { return false; }
};

}  // namespace slam::strategies
