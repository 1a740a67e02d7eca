#pragma once
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/world/plan.h"

namespace slam::metrics {

/// How an estimated map compares with what could be seen of the true plan. A wall is a point here: the centre
/// of an occupied cell, in metres in the world frame; distances between walls are exact and go from centre to
/// centre, so cells of different size and grids turned against each other compare. Of a true wall only the
/// cells that a beam could hit take part (SeenMask::wall): nobody can map the inside of a block or its far
/// side, and a map that puts walls there is wrong. Shares are in 0 to 1, NaN where their denominator is
/// empty.
struct MapScore {
  double occupied_precision;  ///< of the estimated walls, those within `tolerance_m` of a seen true wall
  double occupied_recall;     ///< of the seen true walls, those within `tolerance_m` of an estimated one
  double occupied_f1;         ///< their harmonic mean; 0 when both are 0, NaN when one is NaN
  /// |T and E| / |T or E|: T is the area of seen free cells, E all the area that the map calls free, wherever
  /// it is; so free space claimed behind a wall or beyond the plan is punished like free space missed.
  double free_iou;
  double wall_to_truth_p50_m, wall_to_truth_p95_m;  ///< from estimated walls to the nearest seen true wall
  double truth_to_wall_p50_m, truth_to_wall_p95_m;  ///< from seen true walls to the nearest estimated one
  double
      known_share;  ///< of the seen cells (free and wall), those whose centre the map calls free or occupied
};

/// The cells that a robot with this truth could have seen: walls that stop a ray and free cells that a ray
/// crosses before it. Same raster as the plan; true = seen.
struct SeenMask {
  int columns = 0, rows = 0;
  std::vector<bool> wall, free;  ///< row-major as Plan::cells
};

/// Rays walk as rays::castRay()'s; max_range_m <= 0 means no limit. To save time, a pose is left out when it
/// is within 0.1 m and 5 degrees of the last one used (the last pose of all is always used). A lidar pose
/// that is not finite, outside the plan or in a wall sees nothing.
SeenMask seenCells(const world::Plan& plan, const core::Trajectory& truth, const core::Pose2& T_robot_lidar,
                   double first_angle_rad, double step_rad, int beams, double max_range_m);

/// `map` is the estimate, in its own map frame; T_world_map places it on the truth (the trajectory's
/// alignment). Areas are counted by cell centres on the plan's raster, subdivided where the map's cells are
/// finer. T_world_map not finite: all NaN. REQUIRES a mask of the plan's size, tolerance_m >= 0.
MapScore scoreMap(const world::Plan& plan, const SeenMask& seen, const world::CellMap& map,
                  const core::Pose2& T_world_map, double tolerance_m);

/// Without truth: how sure a map is of its cells. Map entropy: the mean binary entropy (Shannon; bits, 0 to
/// 1) of the cells that are not `unknown_value`, from occupancy probabilities. Does not see global
/// distortion, and a matter of how many scans a cell got as much as of their agreement. Without known cells,
/// or with a value outside 0 to 1: NaN.
double mapEntropy(const std::vector<float>& occupancy, float unknown_value = 0.5F);

}  // namespace slam::metrics
