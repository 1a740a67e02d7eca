#pragma once
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/rays/beam_table.h"
#include "libslam/world/cell_map.h"

namespace slam::rays {

/// The exact answer that every faster caster has to equal bit for bit.
///
/// The ray is a half-line, cells are unit squares. The hit is the first occupied cell that a 4-connected walk
/// enters, and the distance is that to the point of entry on the cell's face (not its centre). Origin in an
/// occupied cell: 0; an origin exactly on a grid line is in the cell ahead of it. Nothing hit before the
/// map's edge or up to max_range_m: +infinity. Unknown cells are transparent. Only a wall stops a ray.
///
/// Arithmetic, in cells (so that any engine can restart the walk at any column and get the same bits): u is
/// the major axis, x where |cos| = |sin|, and v the minor one, both made growing by negating coordinate and
/// direction; m = min(minor / major, 1 - 2^-36); row(u) = ov + (u - ou) * m in double, multiply and add
/// rounded separately; in column u visit (u, v), then (u, v + 1) if row(u + 1) >= v + 1. A ray exactly
/// through a lattice corner is a tie that this rule decides. The distance is (u - ou) / major on the near
/// face of column u, and (v + 1 - ov) / minor, but not outside what column u spans, where row v + 1 is
/// entered. Proved for maps of at most 2^15 cells on a side.
///
/// origin_world and angle_rad in the world frame, for which in an estimated map its own frame stands;
/// max_range_m <= 0 means no limit. A pose that is not finite or outside the map: +infinity. Cost: a few
/// nanoseconds per cell passed.
double castRay(const world::CellMap& map, const core::Point2& origin_world, double angle_rad,
               double max_range_m);

/// The same without a limit, from a point in cells (column, row as reals) along a unit vector in the map's
/// axes; in cells. Here the map's symmetries hold to the bit, ties apart.
double castRayInCells(const world::CellMap& map, const core::Point2& origin, const core::Point2& direction);

/// All beams of a table; out gets one range each. Beam i runs along the table's direction turned by the
/// heading as Rotation does it, which is castRay() along the sum of the angles but for some 1e-16.
void castScan(const world::CellMap& map, const core::Pose2& T_world_lidar, const BeamTable& beams,
              double max_range_m, std::vector<float>& out_ranges_m);

}  // namespace slam::rays
