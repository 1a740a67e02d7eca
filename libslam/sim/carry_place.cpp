#include "libslam/sim/carry_place.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "libslam/world/clearance.h"
#include "libslam/world/region.h"

namespace slam::sim {
namespace {

/// The admissible cells that hang together with that cell, ascending.
std::vector<size_t> cellsAround(const world::Plan& plan, const std::vector<char>& admissible, size_t cell) {
  const auto runs = world::regionRuns(plan.columns, admissible);
  const auto own = std::find_if(runs.begin(), runs.end(), [cell](const world::RegionRun& run) {
    return cell >= run.begin && cell < run.end;
  });
  if (own == runs.end()) return world::largestRegion(plan.columns, admissible);
  std::vector<size_t> cells;
  for (const auto& run : runs)
    for (size_t i = run.begin; run.region == own->region && i < run.end; ++i) cells.push_back(i);
  return cells;
}

core::Pose2 anyHeading(const core::Point2& p, core::RandomStream& random) {
  return {p.x, p.y, random.uniform(-core::kPi, core::kPi)};
}

}  // namespace

std::optional<core::Pose2> placeOf(const std::vector<core::Point2>& visited, const core::Pose2& T_world_from,
                                   core::RandomStream& random) {
  if (visited.empty()) return std::nullopt;
  std::vector<core::Point2> away;
  std::copy_if(visited.begin(), visited.end(), std::back_inserter(away), [&](const core::Point2& p) {
    return core::distance(p, core::position(T_world_from)) >= kCarriedAway_m;
  });
  const auto& places = away.empty() ? visited : away;
  return anyHeading(places[random.below(places.size())], random);
}

std::optional<core::Pose2> randomPlace(const world::Plan& plan, const core::Pose2& T_world_from,
                                       double radius_m, core::RandomStream& random) {
  const auto admissible = world::admissibleCells(plan, radius_m / plan.resolution_m);
  const core::Point2 from = world::pointToCells(plan, core::position(T_world_from));
  const auto cell = static_cast<size_t>(std::floor(from.y)) * static_cast<size_t>(plan.columns) +
                    static_cast<size_t>(std::floor(from.x));
  std::vector<core::Point2> places;
  for (const size_t i : cellsAround(plan, admissible, cell)) {
    const auto columns = static_cast<size_t>(plan.columns);
    const size_t row = i / columns;
    places.push_back(
        world::cellsToPoint(plan, {static_cast<double>(i % columns) + 0.5, static_cast<double>(row) + 0.5}));
  }
  return placeOf(places, T_world_from, random);
}

}  // namespace slam::sim
