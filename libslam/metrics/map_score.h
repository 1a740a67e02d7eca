#pragma once
#include "libslam/core/pose2.h"
#include "libslam/world/plan.h"

namespace slam::metrics {

/// How an estimated map compares with the true plan. NaN where a share has an empty denominator.
struct MapScore {
  double occupied_precision;  ///< estimated walls that lie within `tolerance_m` of a true wall
  double occupied_recall;  ///< true walls that could be seen and lie within `tolerance_m` of an estimated one
  double occupied_f1;
  double free_iou;  ///< intersection over union of free space, within the region that could be seen
  double wall_to_truth_p50_m, wall_to_truth_p95_m;  ///< from estimated walls to the nearest true wall
  double truth_to_wall_p50_m,
      truth_to_wall_p95_m;  ///< and from true (seen) walls to the nearest estimated one
  double known_share;       ///< of the region that could be seen, how much the map claims to know
};

/// The cells that a robot with this truth could have seen: true walls and free cells reached by the given
/// scans' exact rays. Same raster as the plan; true = seen.
struct SeenMask {
  int columns = 0, rows = 0;
  std::vector<bool> wall, free;
};
SeenMask seenCells(const world::Plan& plan, const core::Trajectory& truth, const core::Pose2& T_robot_lidar,
                   double first_angle_rad, double step_rad, int beams, double max_range_m);

/// `map` is the estimate as a Plan (occupied / free / unknown) in its own map frame; T_world_map places it on
/// the truth (the trajectory's alignment). Cells of different size are compared by their centres in metres.
MapScore scoreMap(const world::Plan& plan, const SeenMask& seen, const world::Plan& map,
                  const core::Pose2& T_world_map, double tolerance_m);

/// Without truth: how sharp a map is. Mean binary entropy (bits) of the cells that are not unknown, from
/// occupancy probabilities; and the share of occupied cells among the known (Filatov et al. 2017, arXiv
/// 1708.02354, for the second).
struct MapSharpness {
  double mean_entropy_bits;
  double occupied_share;
};
MapSharpness mapSharpness(const std::vector<float>& occupancy, float unknown_value = 0.5F);

}  // namespace slam::metrics
