#pragma once
#include <string>
#include <vector>

#include "tests/world/drawn_plan.h"

namespace slam::metrics {

/// As world::drawnPlan(), of cells of 0.1 m.
inline world::Plan drawn(const std::vector<std::string>& picture, double resolution_m = 0.1) {
  return world::drawnPlan(picture, resolution_m);
}

}  // namespace slam::metrics
