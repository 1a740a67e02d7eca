#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/world/plan.h"

namespace slam::world {

/// What castScan() may use of the processor. The ranges are the same bits.
enum class Instructions { kPortable, kFastest };

/// castRay() and castScan() with the same bits on every ray, many times faster once a table is made of the
/// plan: for each of the eight octants of direction and each cell, how many columns of the major axis a ray
/// may skip whatever its slope. The walk of castRay() may restart at any column, so a skip costs no exactness.
///
/// Memory: 8 bytes per cell, and one more row and column. Construction: some milliseconds per million cells,
/// paid back by a few hundred scans. The plan is not needed afterwards; a plan that changes needs a new
/// caster. Calls from several threads at once are safe.
class SectorCaster {
 public:
  explicit SectorCaster(const Plan& plan, Instructions instructions = Instructions::kFastest);

  /// As world::castScan().
  void castScan(const core::Pose2& T_world_lidar, double first_angle_rad, double step_rad, int beams,
                double max_range_m, std::vector<float>& out_ranges_m) const;
  /// As world::castRay().
  double castRay(const core::Point2& origin_world, double angle_rad, double max_range_m) const;
  /// As world::castRayInCells().
  double castRayInCells(const core::Point2& origin, const core::Point2& direction) const;

 private:
  const std::uint8_t* octantTable(bool x_is_major, bool x_falls, bool y_falls) const;

  bool uses_avx2_;
  Plan frame_;  ///< size and placement; no cells
  /// Eight tables over cells counted from the octant's own corner, the minor axis contiguous, with a last row
  /// and column of cells outside the plan.
  std::vector<std::uint8_t> codes_;
};

}  // namespace slam::world
