#include "libslam/run/evaluate.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "libslam/core/error.h"
#include "libslam/core/parameters.h"
#include "libslam/logs/trajectory_io.h"

namespace slam::run {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr metrics::ErrorStatistics kNoStatistics{0, kNan, kNan, kNan, kNan, kNan};

double numberOf(const core::Manifest& manifest, const std::string& key, const std::string& path) {
  const auto it = manifest.results.find(key);
  if (it == manifest.results.end())
    throw core::InputError(path + "/manifest.json: key 'results." + key + "' is missing");
  double value = kNan;
  core::parseNumber(it->second, value);  // "nan" stays NaN
  return value;
}

double timeOf(const core::Manifest& manifest, const std::string& key) {
  const auto it = manifest.times_s.find(key);
  return it == manifest.times_s.end() ? kNan : it->second;
}

/// Median over the other methods of the ATE between two estimates: small when a method tells the same story.
double agreementWithOthers(const std::vector<RunFolder>& runs, size_t index) {
  std::vector<double> errors;
  for (size_t i = 0; i < runs.size(); ++i)
    if (i != index && !runs[i].estimate.empty() && !runs[index].estimate.empty())
      errors.push_back(metrics::trajectoryError(runs[i].estimate, runs[index].estimate).position_m.rmse);
  if (errors.empty()) return kNan;
  std::sort(errors.begin(), errors.end());
  const size_t half = errors.size() / 2;
  return errors.size() % 2 ? errors[half] : (errors[half - 1] + errors[half]) / 2;
}

void noteFailures(const std::vector<Evaluation>& evaluations, report::Table& table) {
  for (const auto& e : evaluations)
    if (!e.failure.empty()) table.notes.push_back(e.method + " failed: " + e.failure);
}

const char* const kSingleRun = "One run with one seed: small differences between rows may be chance.";

}  // namespace

RunFolder loadRun(const std::string& folder) {
  RunFolder run;
  run.path = folder;
  run.manifest = core::readManifest(folder + "/manifest.json");
  const auto method = run.manifest.results.find("method");
  if (method == run.manifest.results.end())
    throw core::InputError(folder + ": is not the folder of one method's run (its manifest names no method)");
  run.method = method->second;
  run.estimate = logs::readTum(folder + "/trajectory.tum");
  world::PlanOptions options;
  options.allow_empty = true;  // a naive map claims no free space, a diverged one no walls
  run.map = world::loadPlan(folder + "/map.yaml", options);
  run.cost = {timeOf(run.manifest, "mean_ms_per_scan"), timeOf(run.manifest, "p99_ms_per_scan"),
              numberOf(run.manifest, "peak_memory_mb", folder), timeOf(run.manifest, "real_time_factor")};
  return run;
}

Truth loadTruth(const std::string& truth_path, const std::string& plan_path, const RunFolder& lidar_of) {
  Truth truth;
  truth.trajectory = logs::readTrajectory(truth_path);
  if (plan_path.empty()) return truth;
  truth.plan = world::loadPlan(plan_path);
  const auto lidar = [&](const std::string& key) {
    return numberOf(lidar_of.manifest, "lidar." + key, lidar_of.path);
  };
  truth.seen = metrics::seenCells(
      *truth.plan, truth.trajectory, {lidar("mount_x_m"), lidar("mount_y_m"), lidar("mount_yaw_rad")},
      lidar("first_angle_rad"), lidar("step_rad"), static_cast<int>(lidar("beams")), lidar("max_range_m"));
  return truth;
}

Evaluation failedEvaluation(const std::string& method, const std::string& why) {
  Evaluation e;
  e.method = method;
  e.failure = why;
  e.trajectory = {kNoStatistics, kNoStatistics, {}, 0};
  e.per_metre = e.per_second = {kNoStatistics, kNoStatistics};
  e.map = {kNan, kNan, kNan, kNan, kNan, kNan, kNan, kNan, kNan};
  e.cost = {kNan, kNan, kNan, kNan};
  e.path_length_m = e.map_mean_entropy_bits = e.map_occupied_share = kNan;
  e.end_pose = {kNan, kNan, kNan};
  return e;
}

Evaluation evaluate(const RunFolder& run, const std::optional<Truth>& truth) {
  Evaluation e = failedEvaluation(run.method, "");
  e.cost = run.cost;
  e.path_length_m = core::pathLength(run.estimate);
  if (!run.estimate.empty()) e.end_pose = run.estimate.back().pose;
  e.map_mean_entropy_bits = numberOf(run.manifest, "map_mean_entropy_bits", run.path);
  e.map_occupied_share = numberOf(run.manifest, "map_occupied_share", run.path);
  if (!truth) return e;
  e.trajectory = metrics::trajectoryError(truth->trajectory, run.estimate);
  e.per_metre = metrics::relativeErrorOverDistance(truth->trajectory, run.estimate, 1.0);
  e.per_second = metrics::relativeErrorOverTime(truth->trajectory, run.estimate, 1.0);
  if (truth->plan && truth->seen)
    e.map = metrics::scoreMap(*truth->plan, *truth->seen, run.map, e.trajectory.T_truth_estimate,
                              kWallTolerance_m);
  return e;
}

const std::vector<MetricInfo>& metricInfos() {
  static const std::vector<MetricInfo> infos = {
      {"ate_rmse_m", "ATE rmse m",
       "absolute trajectory error: position after SE(2) least-squares alignment, no scale"},
      {"ate_max_m", "max m", "largest such error"},
      {"heading_rmse_deg", "head. deg", "root mean square heading error after the same alignment"},
      {"rpe_1m_m", "RPE m/m", "relative pose error over 1 m of true path, translation, rmse"},
      {"rpe_1m_deg", "RPE deg/m", "the same, rotation"},
      {"rpe_1s_m", "RPE m/s", "relative pose error over 1 s, translation, rmse"},
      {"wall_f1", "wall F1",
       "estimated against true walls within 0.10 m: harmonic mean of precision and recall"},
      {"wall_precision", "wall prec.", "share of estimated walls that lie within 0.10 m of a true one"},
      {"wall_recall", "wall rec.",
       "share of the true walls that could be seen that were found within 0.10 m"},
      {"free_iou", "free IoU",
       "free space: intersection over union with the true free space that could be seen"},
      {"wall_p50_m", "wall p50", "median distance from estimated walls to the nearest true wall"},
      {"wall_p95_m", "wall p95", "95th percentile of the same"},
      {"missed_p50_m", "missed p50",
       "median distance from true walls that could be seen to the nearest estimated one"},
      {"missed_p95_m", "missed p95", "95th percentile of the same"},
      {"path_length_m", "path m", "length of the estimated path"},
      {"map_entropy_bits", "entropy", "mean entropy of the map's known cells: small is sharp"},
      {"occupied_share", "occupied",
       "share of occupied among the known cells (Filatov et al. 2017): double walls raise it"},
      {"agreement_m", "agree m", "median over the other methods of the ATE between their path and this one"},
      {"ms_per_scan", "ms/scan", "CPU time per scan, one thread, without reading the log"},
      {"p99_ms", "p99 ms", "99th percentile of the same"},
      {"real_time_factor", "x real time", "robot's time over computing time"},
      {"peak_memory_mb", "MB", "peak memory over the process's size before the run"},
  };
  return infos;
}

namespace {

report::Column column(const std::string& key, int decimals) {
  for (const auto& info : metricInfos())
    if (info.key == key) return {key, info.title, decimals};
  throw core::ContractError("no metric '" + key + "'");
}

}  // namespace

report::Table accuracyTable(const std::vector<Evaluation>& evaluations, const Truth& truth) {
  report::Table table;
  table.caption = "Accuracy against the truth";
  table.columns = {{"method", "method", 0},       column("ate_rmse_m", 3), column("ate_max_m", 3),
                   column("heading_rmse_deg", 2), column("rpe_1m_m", 3),   column("rpe_1m_deg", 2)};
  if (truth.plan) {
    for (const char* key : {"wall_f1", "free_iou", "wall_p50_m", "wall_p95_m"})
      table.columns.push_back(column(key, 3));
  }
  for (const auto& e : evaluations) {
    std::vector<report::CellValue> row = {e.method,
                                          e.trajectory.position_m.rmse,
                                          e.trajectory.position_m.max,
                                          core::radToDeg(e.trajectory.heading_rad.rmse),
                                          e.per_metre.translation_m.rmse,
                                          core::radToDeg(e.per_metre.rotation_rad.rmse)};
    if (truth.plan)
      for (const double value :
           {e.map.occupied_f1, e.map.free_iou, e.map.wall_to_truth_p50_m, e.map.wall_to_truth_p95_m})
        row.emplace_back(value);
    table.rows.push_back(std::move(row));
  }
  table.notes.emplace_back(kSingleRun);
  noteFailures(evaluations, table);
  return table;
}

report::Table agreementTable(const std::vector<Evaluation>& evaluations, const std::vector<RunFolder>& runs) {
  report::Table table;
  table.caption = "No truth is known for this log: what can be said without it";
  table.columns = {{"method", "method", 0},           column("path_length_m", 2),
                   {"end_x_m", "end x m", 2},         {"end_y_m", "end y m", 2},
                   {"end_yaw_deg", "end yaw deg", 1}, column("agreement_m", 3),
                   column("map_entropy_bits", 4),     column("occupied_share", 4)};
  for (const auto& e : evaluations) {
    const auto run =
        std::find_if(runs.begin(), runs.end(), [&](const RunFolder& r) { return r.method == e.method; });
    const double agreement =
        run == runs.end() ? kNan : agreementWithOthers(runs, static_cast<size_t>(run - runs.begin()));
    table.rows.push_back({e.method, e.path_length_m, e.end_pose.x, e.end_pose.y,
                          core::radToDeg(e.end_pose.phi), agreement, e.map_mean_entropy_bits,
                          e.map_occupied_share});
  }
  table.notes.emplace_back(kSingleRun);
  noteFailures(evaluations, table);
  return table;
}

report::Table costTable(const std::vector<Evaluation>& evaluations) {
  report::Table table;
  table.caption = "Cost on this machine";
  table.columns = {{"method", "method", 0},
                   column("ms_per_scan", 3),
                   column("p99_ms", 3),
                   column("real_time_factor", 0),
                   column("peak_memory_mb", 1)};
  for (const auto& e : evaluations)
    table.rows.push_back({e.method, e.cost.mean_ms_per_scan, e.cost.p99_ms_per_scan, e.cost.real_time_factor,
                          e.cost.peak_memory_mb});
  return table;
}

}  // namespace slam::run
