#include <algorithm>

#include "libslam/buildings/generator/site.h"
#include "libslam/world/clearance.h"
#include "libslam/world/region.h"

namespace slam::buildings {
namespace {

template <class What>
void forCells(const world::RegionRun& run, What what) {
  for (size_t i = run.begin; i < run.end; ++i) what(i);
}

/// The free cells that have no connection to an admissible one become walls.
void fillUnconnected(world::Plan& plan, const std::vector<char>& admissible) {
  std::vector<char> is_free(plan.cells.size());
  for (size_t i = 0; i < is_free.size(); ++i) is_free[i] = plan.cells[i] == world::Cell::kFree;
  const std::vector<world::RegionRun> runs = world::regionRuns(plan.columns, is_free);
  std::vector<char> is_reached(runs.size(), 0);
  for (const world::RegionRun& run : runs)
    forCells(run, [&](size_t i) { is_reached[run.region] |= admissible[i]; });
  for (const world::RegionRun& run : runs)
    if (!is_reached[run.region]) forCells(run, [&](size_t i) { plan.cells[i] = world::Cell::kOccupied; });
}

}  // namespace

void fillPockets(world::Plan& plan, double radius_cells) {
  for (;;) {
    std::vector<char> admissible = world::admissibleCells(plan, radius_cells);
    const std::vector<world::RegionRun> runs = world::regionRuns(plan.columns, admissible);
    if (runs.empty()) return;
    const size_t largest = world::largestRegionOf(runs);
    std::vector<char> pockets(admissible.size(), 0);
    bool has_pockets = false;
    for (const world::RegionRun& run : runs)
      if (run.region != largest)
        forCells(run, [&](size_t i) { has_pockets = true, pockets[i] = 1, admissible[i] = 0; });
    fillUnconnected(plan, admissible);
    if (!has_pockets) return;
    // What the robot covers from the largest region stays, or filling one place would narrow another.
    const auto kept = world::cellsUnderDiscs(plan.columns, admissible, radius_cells);
    const auto covered = world::cellsUnderDiscs(plan.columns, pockets, radius_cells);
    bool has_filled = false;
    for (size_t i = 0; i < covered.size(); ++i)
      if (covered[i] && !kept[i] && plan.cells[i] == world::Cell::kFree)
        plan.cells[i] = world::Cell::kOccupied, has_filled = true;
    for (size_t i = 0; !has_filled && i < pockets.size(); ++i)
      if (pockets[i]) plan.cells[i] = world::Cell::kOccupied;
  }
}

}  // namespace slam::buildings
