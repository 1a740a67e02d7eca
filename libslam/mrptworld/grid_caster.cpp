#include "libslam/mrptworld/grid_caster.h"

#include <mrpt/random/RandomGenerators.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "libslam/core/error.h"

namespace slam::mrptworld {
namespace {

using mrpt::maps::COccupancyGridMap2D;

world::Cell toCell(COccupancyGridMap2D::cellType log_odds, COccupancyGridMap2D::cellType wall_at_most) {
  if (std::abs(static_cast<int>(log_odds)) <= 1)
    return world::Cell::kUnknown;  // as MRPT's ray simulation has it
  return log_odds <= wall_at_most ? world::Cell::kOccupied : world::Cell::kFree;
}

/// The plan in which a ray ends wherever MRPT's ends: at walls, and at unknown cells where the threshold
/// stops it there.
bool unknownStops(float threshold) {
  return COccupancyGridMap2D::p2l(0.5F) <= COccupancyGridMap2D::p2l(1 - threshold);
}

world::Plan withUnknownAsWalls(world::Plan plan) {
  std::replace(plan.cells.begin(), plan.cells.end(), world::Cell::kUnknown, world::Cell::kOccupied);
  return plan;
}

}  // namespace

world::Plan toPlan(const COccupancyGridMap2D& grid, float threshold) {
  constexpr int kLargestSide = 1 << 15;
  world::Plan plan;
  plan.name = "grid";
  plan.columns = static_cast<int>(grid.getSizeX());
  plan.rows = static_cast<int>(grid.getSizeY());
  if (plan.columns > kLargestSide || plan.rows > kLargestSide)
    throw core::ContractError("toPlan: found a grid of " + std::to_string(plan.columns) + " x " +
                              std::to_string(plan.rows) + " cells, expected at most " +
                              std::to_string(kLargestSide) + " on a side");
  plan.resolution_m = grid.getResolution();
  plan.T_frame_raster = {grid.getXMin(), grid.getYMin(), 0};
  const auto wall_at_most = COccupancyGridMap2D::p2l(1 - threshold);
  const auto& log_odds = grid.getRawMap();
  plan.cells.resize(log_odds.size());
  std::transform(log_odds.begin(), log_odds.end(), plan.cells.begin(),
                 [&](auto cell) { return toCell(cell, wall_at_most); });
  return plan;
}

GridCaster::GridCaster(const COccupancyGridMap2D& grid, float threshold)
    : threshold_(threshold), plan_(toPlan(grid, threshold)), walls_(plan_) {
  if (unknownStops(threshold)) stops_.emplace(withUnknownAsWalls(plan_));
}

void GridCaster::laserScanSimulator(mrpt::obs::CObservation2DRangeScan& scan,
                                    const mrpt::poses::CPose2D& robot_pose, size_t N, float noise_std,
                                    unsigned decimation, float angle_noise_std) const {
  scan.resizeScan(N);
  if (N == 0) return;
  const mrpt::poses::CPose2D sensor = robot_pose + mrpt::poses::CPose2D(scan.sensorPose);
  const double direction = scan.rightToLeft ? 1.0 : -1.0, aperture_rad = scan.aperture;
  const double first_rad = -direction * aperture_rad / 2;
  const double step_rad = N > 1 ? direction * aperture_rad / static_cast<double>(N - 1) : 0.0;
  const core::Pose2 T_map_sensor{sensor.x(), sensor.y(), sensor.phi()};
  auto& generator = mrpt::random::getRandomGenerator();

  std::vector<float> to_wall, to_stop;
  const auto castAll = [&](const rays::SectorCaster& caster, std::vector<float>& ranges) {
    caster.castScan(T_map_sensor, {first_rad, step_rad, static_cast<int>(N)}, scan.maxRange, ranges);
  };
  // A ray turned by noise is no beam of the table.
  const auto castTurned = [&](const rays::SectorCaster& caster, double angle_rad) {
    return static_cast<float>(caster.castRay(core::position(T_map_sensor), angle_rad, scan.maxRange));
  };
  if (angle_noise_std > 0) {
    to_wall.resize(N);
    to_stop.resize(N);
    for (size_t i = 0; i < N; i += std::max(decimation, 1U)) {
      const double turned_by_rad = generator.drawGaussian1D_normalized() * angle_noise_std;
      const double angle_rad =
          T_map_sensor.phi + first_rad + static_cast<double>(i) * step_rad + turned_by_rad;
      to_wall[i] = castTurned(walls_, angle_rad);
      to_stop[i] = stops_ ? castTurned(*stops_, angle_rad) : to_wall[i];
    }
  } else {
    castAll(walls_, to_wall);
    if (stops_) castAll(*stops_, to_stop);
  }
  const std::vector<float>& stop = stops_ ? to_stop : to_wall;
  for (size_t i = 0; i < N; i += std::max(decimation, 1U)) {
    // A nearer stop is an unknown cell, which gives no return; the same wall gives the same bits.
    const bool valid = std::isfinite(to_wall[i]) && to_wall[i] == stop[i];
    float range_m = valid ? to_wall[i] : scan.maxRange;
    if (valid && noise_std > 0)
      range_m += static_cast<float>(generator.drawGaussian1D_normalized()) * noise_std;
    scan.setScanRange(i, range_m);
    scan.setScanRangeValidity(i, valid);
  }
}

void GridCaster::update(const COccupancyGridMap2D& grid, int x0, int y0, int x1, int y1) {
  const bool same =
      static_cast<int>(grid.getSizeX()) == plan_.columns && static_cast<int>(grid.getSizeY()) == plan_.rows;
  if (!same) throw core::ContractError("GridCaster::update: the grid has another size");
  const auto wall_at_most = COccupancyGridMap2D::p2l(1 - threshold_);
  for (int y = std::max(y0, 0); y < std::min(y1, plan_.rows); ++y)
    for (int x = std::max(x0, 0); x < std::min(x1, plan_.columns); ++x) {
      const size_t i = static_cast<size_t>(y) * plan_.columns + x;
      plan_.cells[i] = toCell(grid.getRawMap()[i], wall_at_most);
    }
  walls_.update(plan_, x0, y0, x1, y1);
  if (stops_) stops_->update(withUnknownAsWalls(plan_), x0, y0, x1, y1);
}

}  // namespace slam::mrptworld
