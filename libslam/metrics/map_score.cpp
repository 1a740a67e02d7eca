#include "libslam/metrics/map_score.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/core/rigid_motion2.h"
#include "libslam/metrics/nearest_points.h"
#include "libslam/metrics/statistics.h"

namespace slam::metrics {
namespace {

using core::kNaN;
constexpr double kRounding_m = 1e-9;  // "within the tolerance" must not depend on the last digit of a centre

/// A raster placed in the world: cell coordinates in cells, points in metres.
struct Placed {
  const world::CellMap& raster;
  core::Pose2 T_world_raster;

  core::Point2 centre(int column, int row) const {
    return T_world_raster *
           core::Point2{(column + 0.5) * raster.resolution_m, (row + 0.5) * raster.resolution_m};
  }
};

/// The cell of `raster` at a point given in its own frame; unknown outside.
world::Cell cellAt(const world::CellMap& raster, const core::Point2& p_raster) {
  const double column = std::floor(p_raster.x / raster.resolution_m);
  const double row = std::floor(p_raster.y / raster.resolution_m);
  if (!(column >= 0 && row >= 0 && column < raster.columns && row < raster.rows))
    return world::Cell::kUnknown;
  return raster.at(static_cast<int>(column), static_cast<int>(row));
}

template <class Predicate>
std::vector<core::Point2> centresWhere(const Placed& placed, Predicate chosen) {
  std::vector<core::Point2> centres;
  for (int row = 0; row < placed.raster.rows; ++row)
    for (int column = 0; column < placed.raster.columns; ++column)
      if (chosen(static_cast<size_t>(row) * placed.raster.columns + column))
        centres.push_back(placed.centre(column, row));
  return centres;
}

/// Distance of each point to the nearest of the others; all infinite when there are no others.
std::vector<double> nearestDistances(const std::vector<core::Point2>& from,
                                     const std::vector<core::Point2>& to) {
  const NearestPoints nearest(to);
  std::vector<double> distances_m;
  distances_m.reserve(from.size());
  for (const auto& p : from) distances_m.push_back(nearest.distance(p));
  return distances_m;
}

double shareOf(size_t part, size_t whole) {
  return whole == 0 ? kNaN : static_cast<double>(part) / static_cast<double>(whole);
}

double shareWithin(const std::vector<double>& distances_m, double tolerance_m) {
  const auto within = std::count_if(distances_m.begin(), distances_m.end(),
                                    [&](double d) { return d <= tolerance_m + kRounding_m; });
  return shareOf(static_cast<size_t>(within), distances_m.size());
}

/// Infinite distances (nothing to be near to) have no quantile.
double distanceQuantile(const std::vector<double>& distances_m, double share) {
  const double value = quantile(distances_m, share);
  return std::isfinite(value) ? value : kNaN;
}

double harmonicMean(double a, double b) {
  if (a == 0 && b == 0) return 0;
  return 2 * a * b / (a + b);
}

struct CellRange {
  int first_column = 0, first_row = 0, last_column = -1, last_row = -1;  ///< inclusive
};

/// The plan's raster extended, in its own cells and also below 0, to hold all that the map calls free.
CellRange rangeOfBoth(const world::Plan& plan, const world::CellMap& map,
                      const core::RigidMotion2& T_plan_map) {
  double x0 = 0, y0 = 0, x1 = plan.columns - 1, y1 = plan.rows - 1;
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column) {
      if (map.at(column, row) != world::Cell::kFree) continue;
      for (const int corner : {0, 1, 2, 3}) {
        const auto p = T_plan_map * core::Point2{(column + (corner & 1)) * map.resolution_m,
                                                 (row + (corner >> 1)) * map.resolution_m};
        x0 = std::min(x0, std::floor(p.x / plan.resolution_m));
        y0 = std::min(y0, std::floor(p.y / plan.resolution_m));
        x1 = std::max(x1, std::floor(p.x / plan.resolution_m));
        y1 = std::max(y1, std::floor(p.y / plan.resolution_m));
      }
    }
  return {static_cast<int>(x0), static_cast<int>(y0), static_cast<int>(x1), static_cast<int>(y1)};
}

double freeIntersectionOverUnion(const world::Plan& plan, const SeenMask& seen, const world::CellMap& map,
                                 const core::Pose2& T_map_plan) {
  const auto range = rangeOfBoth(plan, map, core::RigidMotion2(core::inverse(T_map_plan)));
  const core::RigidMotion2 T_map_cells(T_map_plan);
  // Finer map cells are all visited at least once when the plan's cells are cut to their size.
  const int cuts = std::max(1, static_cast<int>(std::ceil(plan.resolution_m / map.resolution_m - 1e-6)));
  const double step_m = plan.resolution_m / cuts;
  size_t both = 0, either = 0;
  for (int row = range.first_row; row <= range.last_row; ++row)
    for (int column = range.first_column; column <= range.last_column; ++column) {
      const bool truly =
          plan.contains(column, row) && seen.free[static_cast<size_t>(row) * plan.columns + column];
      for (int part = 0; part < cuts * cuts; ++part) {
        const int sub_column = part % cuts, sub_row = part / cuts;
        const core::Point2 p_plan{column * plan.resolution_m + (sub_column + 0.5) * step_m,
                                  row * plan.resolution_m + (sub_row + 0.5) * step_m};
        const bool claimed = cellAt(map, T_map_cells * p_plan) == world::Cell::kFree;
        both += truly && claimed;
        either += truly || claimed;
      }
    }
  return shareOf(both, either);
}

double knownShare(const world::Plan& plan, const SeenMask& seen, const world::CellMap& map,
                  const core::Pose2& T_map_plan) {
  const Placed plan_in_map{plan, T_map_plan};
  size_t known = 0;
  const auto centres =
      centresWhere(plan_in_map, [&](size_t cell) { return seen.free[cell] || seen.wall[cell]; });
  for (const auto& p_map : centres) known += cellAt(map, p_map) != world::Cell::kUnknown;
  return shareOf(known, centres.size());
}

double entropyBits(double p) {
  return p <= 0 || p >= 1 ? 0.0 : -p * core::log2(p) - (1 - p) * core::log2(1 - p);
}

}  // namespace

MapScore scoreMap(const world::Plan& plan, const SeenMask& seen, const world::CellMap& map,
                  const core::Pose2& T_world_map, double tolerance_m) {
  if (seen.columns != plan.columns || seen.rows != plan.rows || seen.wall.size() != plan.cells.size() ||
      seen.free.size() != plan.cells.size())
    throw core::ContractError("scoreMap: the mask is not the plan's");
  if (!(tolerance_m >= 0)) throw core::ContractError("scoreMap: tolerance_m must not be below 0");
  if (!core::isFinite(T_world_map)) return {kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN};

  const Placed true_raster{plan, plan.T_frame_raster};
  const Placed map_raster{map, T_world_map * map.T_frame_raster};
  const auto true_walls = centresWhere(true_raster, [&](size_t cell) { return seen.wall[cell]; });
  const auto map_walls =
      centresWhere(map_raster, [&](size_t cell) { return map.cells[cell] == world::Cell::kOccupied; });
  const auto wall_to_truth_m = nearestDistances(map_walls, true_walls);
  const auto truth_to_wall_m = nearestDistances(true_walls, map_walls);
  // Both rasters in the frame of the map's own cells.
  const auto T_map_plan = core::between(map_raster.T_world_raster, true_raster.T_world_raster);

  MapScore score{};
  score.occupied_precision = shareWithin(wall_to_truth_m, tolerance_m);
  score.occupied_recall = shareWithin(truth_to_wall_m, tolerance_m);
  score.occupied_f1 = harmonicMean(score.occupied_precision, score.occupied_recall);
  score.free_iou = freeIntersectionOverUnion(plan, seen, map, T_map_plan);
  score.wall_to_truth_p50_m = distanceQuantile(wall_to_truth_m, 0.5);
  score.wall_to_truth_p95_m = distanceQuantile(wall_to_truth_m, 0.95);
  score.truth_to_wall_p50_m = distanceQuantile(truth_to_wall_m, 0.5);
  score.truth_to_wall_p95_m = distanceQuantile(truth_to_wall_m, 0.95);
  score.known_share = knownShare(plan, seen, map, T_map_plan);
  return score;
}

double mapEntropy(const std::vector<float>& occupancy, float unknown_value) {
  size_t known = 0;
  double entropy_bits = 0;
  for (const float p : occupancy) {
    if (!(p >= 0 && p <= 1)) return kNaN;
    if (p == unknown_value) continue;
    ++known;
    entropy_bits += entropyBits(p);
  }
  return known == 0 ? kNaN : entropy_bits / static_cast<double>(known);
}

}  // namespace slam::metrics
