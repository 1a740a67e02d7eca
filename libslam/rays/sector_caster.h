#pragma once
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/rays/beam_table.h"
#include "libslam/rays/sector_march.h"
#include "libslam/rays/sector_table.h"
#include "libslam/world/cell_map.h"

namespace slam::rays {

/// What castScan() may use of the processor. The ranges are the same bits.
enum class Instructions { kPortable, kAvx2, kAvx512, kFastest };

/// False for what this processor lacks.
bool isSupported(Instructions instructions);

/// castRay() and castScan() with the same bits on every ray, many times faster once a SectorTable is made of
/// the map. castScan() advances all beams of a scan together, one look-up each per pass, eight or sixteen at
/// a time where the processor has the registers; it is the fast one.
///
/// Memory: 8 bytes per cell, and one more row and column. Construction: some milliseconds per million cells,
/// paid back by some dozens of scans. The map is not needed afterwards. Calls from several threads at once
/// are safe, but for update().
class SectorCaster {
 public:
  /// ContractError for instructions that the processor lacks.
  explicit SectorCaster(const world::CellMap& map, Instructions instructions = Instructions::kFastest);

  /// As rays::castScan().
  void castScan(const core::Pose2& T_world_lidar, const BeamTable& beams, double max_range_m,
                std::vector<float>& out_ranges_m) const;
  /// Beams first .. first + count - 1 of the table only; out_ranges_m gets `count` ranges.
  void castBeams(const core::Pose2& T_world_lidar, const BeamTable& beams, int first, int count,
                 double max_range_m, float* out_ranges_m) const;
  /// The same scan from every pose, one after the other in out_ranges_m. Up to `threads` threads; the ranges
  /// do not depend on how many.
  void castScans(const std::vector<core::Pose2>& T_world_lidars, const BeamTable& beams, double max_range_m,
                 int threads, std::vector<float>& out_ranges_m) const;
  /// As rays::castRay().
  double castRay(const core::Point2& origin_world, double angle_rad, double max_range_m) const;
  /// As rays::castRayInCells().
  double castRayInCells(const core::Point2& origin, const core::Point2& direction) const;

  /// As SectorTable::update(): a door was shut, a thing was put somewhere.
  void update(const world::CellMap& map, int x0, int y0, int x1, int y1) {
    table_.update(map, x0, y0, x1, y1);
  }

 private:
  const ScanKernel* kernel_;
  world::CellMap frame_;  ///< size and placement; no cells
  SectorTable table_;
};

}  // namespace slam::rays
