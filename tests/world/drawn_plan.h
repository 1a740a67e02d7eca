#pragma once
#include <string>
#include <vector>

#include "libslam/world/plan.h"

namespace slam::world {

/// A plan as drawn: the first line is the top row; '#' occupied, '.' free, '?' unknown. 1 m cells.
inline Plan drawnPlan(const std::vector<std::string>& lines, double resolution_m = 1.0) {
  Plan plan;
  plan.name = "drawn";
  plan.rows = static_cast<int>(lines.size());
  plan.columns = static_cast<int>(lines.front().size());
  plan.resolution_m = resolution_m;
  for (auto line = lines.rbegin(); line != lines.rend(); ++line)
    for (const char c : *line)
      plan.cells.push_back(c == '#' ? Cell::kOccupied : c == '.' ? Cell::kFree : Cell::kUnknown);
  return plan;
}

}  // namespace slam::world
