#pragma once
#include "libslam/navigate/map_strategy.h"

namespace slam::navigate {

/// The next best view with a look one view further. One view is worth gain * exp(-lambda * length) (Gonzalez-Banos
/// and Latombe, "Navigation strategies for exploring indoor environments", IJRR 21(10-11), 2002, section 5); a
/// first view is worth that and the best second view after it, whose gain counts only what the first would
/// not show already and whose length runs by the ways from the robot to both.
class NextBestView : public MapStrategy {
 public:
  NextBestView(const StrategyOptions& options, core::RandomStream) : MapStrategy(options) {}

 private:
  std::optional<Choice> choose(const Scene& scene) override;
};

}  // namespace slam::navigate
