#include "libslam/gridmap/fused_raster.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/core/rigid_motion2.h"

namespace slam::gridmap {
namespace {

constexpr float kUnknown = 0.5F;

bool isKnown(float p) {
  return p < kFreeBelow || p > kOccupiedAbove;
}

/// In cells of a lattice: [x0, x1) x [y0, y1).
struct Extent {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// The cells of `own`'s lattice, which may be negative, that hold all of the other map.
void include(Extent& extent, const OccupancyRaster& own, const PlacedRaster& other) {
  const auto& map = *other.map;
  for (const int column : {0, map.columns})
    for (const int row : {0, map.rows}) {
      const core::Point2 p = other.T_frame_map * core::Point2{map.x_min_m + column * map.resolution_m,
                                                              map.y_min_m + row * map.resolution_m};
      extent.x0 = std::min(extent.x0, own.columnOf(p.x));
      extent.y0 = std::min(extent.y0, own.rowOf(p.y));
      extent.x1 = std::max(extent.x1, own.columnOf(p.x) + 1);
      extent.y1 = std::max(extent.y1, own.rowOf(p.y) + 1);
    }
}

OccupancyRaster grown(const OccupancyRaster& own, const Extent& extent) {
  OccupancyRaster map;
  map.columns = extent.x1 - extent.x0;
  map.rows = extent.y1 - extent.y0;
  map.resolution_m = own.resolution_m;
  map.x_min_m = own.x_min_m + extent.x0 * own.resolution_m;
  map.y_min_m = own.y_min_m + extent.y0 * own.resolution_m;
  map.occupancy.assign(static_cast<std::size_t>(map.columns) * static_cast<std::size_t>(map.rows), kUnknown);
  for (int row = 0; row < own.rows; ++row)
    std::copy_n(
        own.occupancy.begin() + static_cast<std::ptrdiff_t>(row) * own.columns, own.columns,
        map.occupancy.begin() + static_cast<std::ptrdiff_t>(row - extent.y0) * map.columns - extent.x0);
  return map;
}

/// Calls take(cell, p) for every cell of `map` whose centre lies in the other one, p what that has there.
template <class Take>
void sample(OccupancyRaster& map, const PlacedRaster& other, const Take& take) {
  const auto& from = *other.map;
  const core::RigidMotion2 T_from_frame(core::inverse(other.T_frame_map));
  std::size_t cell = 0;
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column, ++cell) {
      const core::Point2 p = T_from_frame * map.centreOf(column, row);
      const int c = from.columnOf(p.x), r = from.rowOf(p.y);
      if (from.contains(c, r)) take(map.occupancy[cell], from.at(c, r));
    }
}

double logOdds(float p) {
  const double held =
      std::clamp(static_cast<double>(p), 1.0 - static_cast<double>(kSurest), static_cast<double>(kSurest));
  return core::log(held / (1 - held));
}

}  // namespace

OccupancyRaster filledFrom(const OccupancyRaster& own, const std::vector<PlacedRaster>& others) {
  Extent extent{0, 0, own.columns, own.rows};
  for (const auto& other : others) include(extent, own, other);
  OccupancyRaster map = grown(own, extent);
  OccupancyRaster surest = map;
  std::fill(surest.occupancy.begin(), surest.occupancy.end(), kUnknown);
  for (const auto& other : others)
    sample(surest, other, [](float& best, float p) {
      if (std::abs(p - kUnknown) > std::abs(best - kUnknown)) best = p;
    });
  for (std::size_t cell = 0; cell < map.occupancy.size(); ++cell)
    if (!isKnown(map.occupancy[cell]) && isKnown(surest.occupancy[cell]))
      map.occupancy[cell] = surest.occupancy[cell];
  return map;
}

OccupancyRaster merged(const std::vector<PlacedRaster>& maps) {
  if (maps.empty()) return {};
  const auto& first = *maps.front().map;
  Extent extent{0, 0, 0, 0};
  for (const auto& map : maps) include(extent, first, map);
  OccupancyRaster sum = grown({0, 0, first.resolution_m, first.x_min_m, first.y_min_m, {}}, extent);
  std::fill(sum.occupancy.begin(), sum.occupancy.end(), 0.0F);
  for (const auto& map : maps)
    sample(sum, map, [](float& evidence, float p) { evidence += static_cast<float>(logOdds(p)); });
  for (auto& p : sum.occupancy)
    p = p == 0 ? kUnknown : static_cast<float>(1 / (1 + core::exp(-static_cast<double>(p))));
  return sum;
}

}  // namespace slam::gridmap
