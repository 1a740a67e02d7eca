#pragma once
#include "libslam/strategies/map_strategy.h"

namespace slam::strategies {

/// Drives to the viewpoint with the largest expected entropy reduction (see expectedGain()) per cost of the
/// way there. Trading gain against the cost of the way: Burgard, Moors, Stachniss and Schneider, "Coordinated
/// multi-robot exploration" (IEEE T-RO 21(3), 2005), where the difference is taken; the quotient
/// needs no weight between bits and metres. 1 m is added to the cost, so that a gain next to the robot does
/// not count for ever;
/// view_bonus_m2 is added to the gain, see NextBestView.
class InformationGain : public MapStrategy {
 public:
  InformationGain(const StrategyOptions& options, core::RandomStream) : MapStrategy(options) {}

 private:
  std::optional<Choice> choose(const Prospects& prospects) override;
};

}  // namespace slam::strategies
