#pragma once
#include <algorithm>
#include <string>
#include <vector>

#include "libslam/world/plan.h"

namespace slam::world {

/// A plan as drawn: the first line is the top row; '#' occupied, '.' free, '?' unknown; 'G' glass, 'M' mirror,
/// 'D' dark are occupied too, and only with one of them has the plan materials. 1 m cells.
inline Plan drawnPlan(const std::vector<std::string>& lines, double resolution_m = 1.0) {
  Plan plan;
  plan.name = "drawn";
  plan.rows = static_cast<int>(lines.size());
  plan.columns = static_cast<int>(lines.front().size());
  plan.resolution_m = resolution_m;
  for (auto line = lines.rbegin(); line != lines.rend(); ++line)
    for (const char c : *line) {
      plan.cells.push_back(c == '.' ? Cell::kFree : c == '?' ? Cell::kUnknown : Cell::kOccupied);
      plan.materials.push_back(c == 'G'   ? Material::kGlass
                               : c == 'M' ? Material::kMirror
                               : c == 'D' ? Material::kDark
                                          : Material::kPlain);
    }
  const auto isPlain = [](Material material) { return material == Material::kPlain; };
  if (std::all_of(plan.materials.begin(), plan.materials.end(), isPlain)) plan.materials.clear();
  return plan;
}

}  // namespace slam::world
