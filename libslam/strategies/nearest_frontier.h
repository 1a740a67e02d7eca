#pragma once
#include "libslam/strategies/map_strategy.h"

namespace slam::strategies {

/// Drives to the frontier that is nearest by the way there, wherever it is and however large (Yamauchi, "A
/// frontier-based approach for autonomous exploration", CIRA 1997). The score is minus the cost of the way.
class NearestFrontier : public MapStrategy {
 public:
  NearestFrontier(const StrategyOptions& options, core::RandomStream) : MapStrategy(options) {}

 private:
  std::optional<Choice> choose(const Prospects& prospects) override;
  bool wantsStandoffs() const override { return false; }
};

}  // namespace slam::strategies
