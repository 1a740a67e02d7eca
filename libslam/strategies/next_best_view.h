#pragma once
#include <vector>

#include "libslam/strategies/map_strategy.h"

namespace slam::strategies {

/// The next best view with a look further ahead. One view is worth gain * exp(-lambda * length)
/// (Gonzalez-Banos and Latombe, "Navigation strategies for exploring indoor environments", IJRR 21(10-11),
/// 2002). A first view is worth that and the best view after it, whose gain counts only what the
/// first does not show already and whose length runs along the known ways (`horizon` views in all, each the
/// best after the one before). Ours: view_bonus_m2 is added to every gain, because a small frontier that is
/// left behind now has to be come back for.
class NextBestView : public MapStrategy {
 public:
  NextBestView(const StrategyOptions& options, core::RandomStream) : MapStrategy(options) {}

 private:
  std::optional<Choice> choose(const Prospects& prospects) override;

  std::vector<char> shown_;  ///< by cell; none between two decisions
};

}  // namespace slam::strategies
