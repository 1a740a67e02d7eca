#pragma once
#include "libslam/explore/explore.h"
#include "libslam/strategies/map_strategy.h"

/// Where to go next. The base class reads the map, finds the frontiers in reach and the ways to places that
/// they can be seen from (libslam/strategies/map_strategy.h); this one only says which place is the best.
class @Name@ : public slam::strategies::MapStrategy {
 public:
  @Name@(const slam::strategies::StrategyOptions& options, slam::core::RandomStream) : MapStrategy(options) {}

 private:
  std::optional<Choice> choose(const slam::strategies::Prospects& prospects) override;
  /// Only the places nearest to each frontier; true adds places on the way there, from which it can be seen,
  /// too.
  bool wantsStandoffs() const override { return false; }
};

/// What the closed loop makes it from.
slam::explore::OwnStrategy ownStrategy();
