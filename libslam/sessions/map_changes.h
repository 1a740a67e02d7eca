#pragma once
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/world/cell_map.h"

namespace slam::sessions {

/// A piece of wall, or a piece of furniture, that one map has where the other is free.
struct MapChange {
  enum class Kind { kNew, kGone } kind;
  core::Point2 least, most;  ///< the box around it, m
  double area_m2 = 0;        ///< of its occupied cells: what was seen of its surface
  core::Point2 centre() const { return {0.5 * (least.x + most.x), 0.5 * (least.y + most.y)}; }
};

struct MapChanges {
  std::vector<MapChange> changes;  ///< the largest box first; equal ones by place
  double compared_m2 = 0;          ///< known in both maps
};

/// What has changed between two estimated maps of one frame. An occupied cell of the later map has come where
/// the earlier one is free and has no wall within kTolerance_m; the other way round it has gone; what either
/// does not know is no change. Cells that lie within kGap_m of one another are one change; smaller ones than
/// kLeast_m across are taken for noise.
MapChanges findChanges(const world::CellMap& before, const world::CellMap& after);
inline constexpr double kTolerance_m = 0.15, kGap_m = 0.2, kLeast_m = 0.15;

}  // namespace slam::sessions
