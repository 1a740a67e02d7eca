#include "libslam/score/metric_infos.h"

#include <cmath>

#include "libslam/core/numbers.h"
#include "libslam/core/pose2.h"

namespace slam::score {
namespace {

using core::kNaN;

/// A count of a map that has cells; a failed method has none.
double countOf(const Evaluation& e, std::size_t count) {
  return std::isnan(e.structure.occupied_share) ? kNaN : static_cast<double>(count);
}

/// A row of metricInfos(); its fields stand as they are read.
struct MetricRow {  // NOLINT(clang-analyzer-optin.performance.Padding)
  const char *key, *title, *meaning;
  int decimals;
  double (*value)(const Evaluation&);
  std::optional<stats::Better> better = stats::Better::kSmaller;
  bool is_cost = false;
};

using E = Evaluation;
constexpr auto kSmaller = stats::Better::kSmaller, kLarger = stats::Better::kLarger;
constexpr auto kNeither = std::nullopt;
constexpr MetricRow kMetrics[] = {
    {"ate_rmse_m", "ATE online m",
     "absolute trajectory error of the path given online: position after SE(2) least-squares alignment, no "
     "scale; a run localised in a known map is not aligned",
     3, [](const E& e) { return e.trajectory.position_m.rmse; }},
    {"ate_final_m", "ATE final m", "the same for the final path; equal where the method corrects nothing", 3,
     [](const E& e) { return e.final_trajectory.position_m.rmse; }},
    {"ate_max_m", "max m", "largest such error", 3, [](const E& e) { return e.trajectory.position_m.max; }},
    {"heading_rmse_deg", "heading deg", "root mean square heading error after the same alignment", 2,
     [](const E& e) { return core::radToDeg(e.trajectory.heading_rad.rmse); }},
    {"rpe_1m_m", "RPE m/m", "relative pose error over 1 m of true path, translation, rmse", 3,
     [](const E& e) { return e.per_metre.translation_m.rmse; }},
    {"rpe_1m_deg", "RPE deg/m", "relative pose error over 1 m of true path, rotation, rmse", 2,
     [](const E& e) { return core::radToDeg(e.per_metre.rotation_rad.rmse); }},
    {"rpe_1s_m", "RPE m/s", "relative pose error over 1 s, translation, rmse", 3,
     [](const E& e) { return e.per_second.translation_m.rmse; }},
    {"rpe_1s_deg", "RPE deg/s", "relative pose error over 1 s, rotation, rmse", 2,
     [](const E& e) { return core::radToDeg(e.per_second.rotation_rad.rmse); }},
    {"wall_f1", "wall F1",
     "estimated against true walls within 0.10 m: harmonic mean of precision and recall", 3,
     [](const E& e) { return e.map.occupied_f1; }, kLarger},
    {"wall_precision", "wall prec.", "share of the estimated walls within 0.10 m of a true one", 3,
     [](const E& e) { return e.map.occupied_precision; }, kLarger},
    {"wall_recall", "wall rec.",
     "share of the true walls that could be seen within 0.10 m of an estimated one", 3,
     [](const E& e) { return e.map.occupied_recall; }, kLarger},
    {"free_iou", "free IoU",
     "free space: intersection over union with the true free space that could be seen", 3,
     [](const E& e) { return e.map.free_iou; }, kLarger},
    {"wall_p50_m", "wall p50 m", "median distance from estimated walls to the nearest true wall", 3,
     [](const E& e) { return e.map.wall_to_truth_p50_m; }},
    {"wall_p95_m", "wall p95 m", "95th percentile of the same", 3,
     [](const E& e) { return e.map.wall_to_truth_p95_m; }},
    {"missed_p50_m", "missed p50 m",
     "median distance from true walls that could be seen to the nearest estimated one", 3,
     [](const E& e) { return e.map.truth_to_wall_p50_m; }},
    {"missed_p95_m", "missed p95 m", "95th percentile of the same", 3,
     [](const E& e) { return e.map.truth_to_wall_p95_m; }},
    {"known_share", "known", "share of the region that could be seen of which the map claims to know", 3,
     [](const E& e) { return e.map.known_share; }, kLarger},
    {"ghost_share", "ghosts",
     "share of the ground that people were on, 0.10 m and more away from walls, that the map calls occupied",
     4, [](const E& e) { return e.ghost_share; }},
    {"anees", "ANEES",
     "error of the pose given online (no alignment: the start is known) against the method's own "
     "covariance, squared, over 3 and averaged: 1 is consistent, above 1 overconfident, below 1 "
     "conservative",
     2, [](const E& e) { return e.anees; }, kNeither},
    {"within_50_share", "in 50 %", "share of the poses within the ellipsoid that should hold half of them", 3,
     [](const E& e) { return e.within_50_share; }, kNeither},
    {"within_95_share", "in 95 %", "the same for 95 %", 3, [](const E& e) { return e.within_95_share; },
     kNeither},
    {"singular_share", "singular",
     "share of the poses whose covariance is singular and excludes where the robot was: a certainty that "
     "was "
     "none; they are in no ellipsoid, and ANEES is of the others",
     3, [](const E& e) { return e.singular_share; }},
    {"anees_final", "ANEES final", "the same of the final poses, where the method states their covariances",
     2, [](const E& e) { return e.anees_final; }, kNeither},
    {"within_50_share_final", "in 50 % final", "share of those within their ellipsoid of 50 %", 3,
     [](const E& e) { return e.within_50_share_final; }, kNeither},
    {"within_95_share_final", "in 95 % final", "share of those within their ellipsoid of 95 %", 3,
     [](const E& e) { return e.within_95_share_final; }, kNeither},
    {"singular_share_final", "singular final", "share of those whose covariance is singular", 3,
     [](const E& e) { return e.singular_share_final; }},
    {"anees_1m", "ANEES 1 m",
     "ANEES of final poses as the one a metre of path before sees them, without any alignment", 2,
     [](const E& e) { return e.relative_1m.anees; }, kNeither},
    {"within_95_share_1m", "in 95 % 1 m", "share of those within their ellipsoid of 95 %", 3,
     [](const E& e) { return e.relative_1m.within_95_share; }, kNeither},
    {"anees_10m", "ANEES 10 m", "the same over ten metres of path", 2,
     [](const E& e) { return e.relative_10m.anees; }, kNeither},
    {"within_95_share_10m", "in 95 % 10 m", "share of those within their ellipsoid of 95 %", 3,
     [](const E& e) { return e.relative_10m.within_95_share; }, kNeither},
    {"anees_loop", "ANEES loop", "the same of the two ends of loops that were closed", 2,
     [](const E& e) { return e.relative_loop.anees; }, kNeither},
    {"within_95_share_loop", "in 95 % loop", "share of those within their ellipsoid of 95 %", 3,
     [](const E& e) { return e.relative_loop.within_95_share; }, kNeither},
    {"path_length_m", "path m", "length of the estimated path", 2, [](const E& e) { return e.path_length_m; },
     kNeither},
    {"end_x_m", "end x m", "last estimated pose, map frame", 2, [](const E& e) { return e.end_pose.x; },
     kNeither},
    {"end_y_m", "end y m", "last estimated pose, map frame", 2, [](const E& e) { return e.end_pose.y; },
     kNeither},
    {"end_yaw_deg", "end yaw deg", "last estimated pose, map frame", 1,
     [](const E& e) { return core::radToDeg(e.end_pose.phi); }, kNeither},
    {"agreement_m", "agree m", "median over the other methods of the ATE between their path and this one", 3,
     [](const E& e) { return e.agreement_m; }},
    {"wall_thickness_m", "walls m",
     "without truth: how far the scans' points lie from the line through those around them, median: "
     "double walls raise it, a global distortion does not",
     3, [](const E& e) { return e.wall_thickness_m; }},
    {"mean_map_entropy", "point entropy",
     "without truth: mean map entropy of the placed points, nats (Droeschel and Behnke 2018): small is "
     "sharp; a global distortion does not lower it",
     3, [](const E& e) { return e.mean_map_entropy; }},
    {"on_wall_share", "on wall",
     "without truth: share of the scans' returns that end within 0.10 m of a wall of the map", 3,
     [](const E& e) { return e.on_wall_share; }, kLarger},
    {"through_wall_share", "cross wall",
     "without truth: share of the returns whose beam comes out of a wall of the map again before it ends", 3,
     [](const E& e) { return e.through_wall_share; }},
    {"map_entropy_bits", "cell entropy",
     "without truth: mean entropy of the map's known cells: small is sharp", 4,
     [](const E& e) { return e.map_mean_entropy_bits; }},
    {"occupied_share", "occupied",
     "without truth: share of occupied among the known cells (Filatov et al. 2017): double walls raise it; "
     "compare maps of one rasteriser only",
     4, [](const E& e) { return e.structure.occupied_share; }, kNeither},
    {"corners", "corners", "without truth: corners, crossings and ends of walls (same source): as above", 0,
     [](const E& e) { return countOf(e, e.structure.corners); }, kNeither},
    {"enclosed_areas", "areas",
     "without truth: free areas cut off from the largest one (same source): as above", 0,
     [](const E& e) { return countOf(e, e.structure.enclosed_areas); }, kNeither},
    {"lost_share", "lost", "share of the time that the method called itself lost, by its journal", 3,
     [](const E& e) { return e.lost_share; }},
    {"ms_per_scan", "ms/scan", "CPU time per scan, one thread, without reading the log", 3,
     [](const E& e) { return e.cost.mean_ms_per_scan; }, kSmaller, true},
    {"p99_ms", "p99 ms", "99th percentile of the same", 3, [](const E& e) { return e.cost.p99_ms_per_scan; },
     kSmaller, true},
    {"real_time_factor", "x real time", "robot's time over computing time", 0,
     [](const E& e) { return e.cost.real_time_factor; }, kLarger, true},
    {"peak_memory_mb", "MB", "peak memory over the process's size before the run", 1,
     [](const E& e) { return e.cost.peak_memory_mb; }, kSmaller, true},
};

}  // namespace

const std::vector<MetricInfo>& metricInfos() {
  static const std::vector<MetricInfo> infos = [] {
    std::vector<MetricInfo> list;
    for (const auto& [key, title, meaning, decimals, value, better, is_cost] : kMetrics)
      list.push_back({key, title, meaning, decimals, value, better, is_cost});
    return list;
  }();
  return infos;
}

const std::vector<std::string>& costKeys() {
  static const std::vector<std::string> keys = {"ms_per_scan", "p99_ms", "real_time_factor",
                                                "peak_memory_mb"};
  return keys;
}

}  // namespace slam::score
