#pragma once
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "libslam/core/random.h"
#include "libslam/world/plan.h"

namespace slam::world {

/// A plan as drawn: the first line is the top row; '#' occupied, '.' free, '?' unknown; 'G' glass, 'M'
/// mirror, 'D' dark are occupied too, and only with one of them has the plan materials. 1 m cells.
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

/// One cell in `one_in` is a wall; the rim is open.
inline Plan scatteredPlan(int columns, int rows, std::uint64_t seed, int one_in) {
  Plan plan;
  plan.columns = columns;
  plan.rows = rows;
  plan.resolution_m = 0.05;
  core::RandomStream random(seed, "scattered plan");
  for (int i = 0; i < columns * rows; ++i)
    plan.cells.push_back(random.below(static_cast<std::uint64_t>(one_in)) == 0 ? Cell::kOccupied
                                                                               : Cell::kFree);
  return plan;
}

}  // namespace slam::world
