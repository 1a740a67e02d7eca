#pragma once
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>

#include <optional>

#include "libslam/rays/sector_caster.h"
#include "libslam/world/plan.h"

namespace slam::mrptworld {

/// The grid as a plan: a cell is a wall when its occupancy is at least `threshold` (its probability of being
/// free at most 1 - threshold, as MRPT compares its log-odds), unknown when its probability is that of a cell
/// never seen, else free. The plan's frame is the grid's corner (x_min, y_min), placed so that coordinates
/// stay the grid's. ContractError for a grid of more than 2^15 cells on a side.
world::Plan toPlan(const mrpt::maps::COccupancyGridMap2D& grid, float threshold = 0.6F);

/// COccupancyGridMap2D::laserScanSimulator() with exact ranges, many times faster: the same arguments and the
/// same meaning, but that
///  - a range is the distance to the wall's face, where MRPT counts steps of RAYTRACE_STEP_SIZE_IN_CELL_UNITS
///    and may step over a corner;
///  - a wall is seen up to the scan's maxRange, where MRPT gives up at maxRange times that step (0.8 by
///    default);
///  - all rays of all calls go through one table, made here: some milliseconds per million cells, 8 bytes a
///    cell.
/// Where MRPT's ray stops at a cell of unknown state (thresholds up to 0.5), so does this one, and both give
/// no return.
///
/// The grid is not needed afterwards; after a change make a new caster, or update().
class GridCaster {
 public:
  explicit GridCaster(const mrpt::maps::COccupancyGridMap2D& grid, float threshold = 0.6F);

  /// As MRPT's: reads aperture, rightToLeft, maxRange and sensorPose of `scan`; ray i of N is at
  /// -aperture/2 + i * aperture / (N - 1) and only every decimation-th is cast. A ray without return is
  /// invalid and gets maxRange. Noise, where asked for, comes from MRPT's own generator as it does there.
  /// Exact as rays::castScan() is, but that MRPT's scan keeps aperture and ranges as float.
  void laserScanSimulator(mrpt::obs::CObservation2DRangeScan& scan, const mrpt::poses::CPose2D& robot_pose,
                          size_t N = 361, float noise_std = 0, unsigned decimation = 1,
                          float angle_noise_std = 0) const;

  /// Cells x0 .. x1-1 by y0 .. y1-1 of the grid have changed. REQUIRES the same size (ContractError) and
  /// placement. Cost: as SectorTable::update(), and a copy of the plan where unknown cells stop rays.
  void update(const mrpt::maps::COccupancyGridMap2D& grid, int x0, int y0, int x1, int y1);

  const world::Plan& plan() const { return plan_; }

 private:
  float threshold_;
  world::Plan plan_;
  rays::SectorCaster walls_;
  /// Where unknown cells stop rays too: what the nearest stop of any kind is.
  std::optional<rays::SectorCaster> stops_;
};

}  // namespace slam::mrptworld
