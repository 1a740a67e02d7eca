#include "libslam/score/evaluate.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/files/parameters.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/metrics/ghosts.h"
#include "libslam/resources/resources.h"
#include "libslam/results/journal_file.h"
#include "libslam/score/metric_infos.h"
#include "libslam/stats/consistency.h"
#include "libslam/truth/movers_log.h"

namespace slam::score {
namespace {

using core::kNaN;
constexpr metrics::ErrorStatistics kNoStatistics{0, kNaN, kNaN, kNaN, kNaN, kNaN};

/// Median over the other methods of the ATE between two estimates: small when a method tells the same story.
double agreementWithOthers(const std::vector<results::RunFolder>& runs, size_t index) {
  std::vector<double> errors;
  for (size_t i = 0; i < runs.size(); ++i)
    if (i != index && !runs[i].estimate.empty() && !runs[index].estimate.empty())
      errors.push_back(metrics::trajectoryError(runs[i].estimate, runs[index].estimate).position_m.rmse);
  if (errors.empty()) return kNaN;
  std::sort(errors.begin(), errors.end());
  const size_t half = errors.size() / 2;
  return errors.size() % 2 ? errors[half] : (errors[half - 1] + errors[half]) / 2;
}

}  // namespace

Truth loadTruth(const std::string& truth_path, const std::string& plan_path,
                const results::RunFolder& lidar_of) {
  Truth truth;
  truth.trajectory = logs::readTrajectory(truth_path);
  if (plan_path.empty()) return truth;
  truth.plan = world::loadPlan(plan_path);
  truth.people = truth::readPeople(truth_path);
  const auto lidar = [&](const std::string& key) {
    return results::resultOf(lidar_of.manifest, "lidar." + key, lidar_of.path);
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
  e.trajectory = e.final_trajectory = {kNoStatistics, kNoStatistics, {}, 0};
  e.per_metre = e.per_second = {kNoStatistics, kNoStatistics};
  e.map = {kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN};
  e.anees = e.within_50_share = e.within_95_share = e.singular_share = kNaN;
  e.anees_final = e.within_50_share_final = e.within_95_share_final = e.singular_share_final = kNaN;
  e.relative_1m = e.relative_10m = e.relative_loop = {kNaN, kNaN};
  e.cost = {kNaN, kNaN, kNaN, kNaN};
  e.ghost_share = e.path_length_m = e.map_mean_entropy_bits = e.agreement_m = e.lost_share = kNaN;
  e.structure = {kNaN, 0, 0};
  e.mean_map_entropy = e.wall_thickness_m = e.on_wall_share = e.through_wall_share = kNaN;
  e.end_pose = {kNaN, kNaN, kNaN};
  return e;
}

StatedErrors statedErrors(const results::RunFolder& run, const Truth& truth, const Alignment& alignment) {
  std::optional<core::Pose2> T_world_map;
  if (alignment.how == metrics::Align::kNone) T_world_map = alignment.T_truth_map;
  StatedErrors errors;
  if (!run.covariances.empty())
    errors.online = results::poseNees(truth.trajectory, run.estimate, run.covariances, T_world_map);
  if (!run.final_covariances.empty())
    errors.final_poses =
        results::poseNees(truth.trajectory, *run.final_estimate, run.final_covariances, T_world_map);
  return errors;
}

namespace {

void judgeCovariances(const StatedErrors& errors, Evaluation& e) {
  if (const auto online = stats::consistency({errors.online}, results::kPoseDegreesOfFreedom)) {
    e.anees = online->anees.value;
    e.within_50_share = online->coverage50.value;
    e.within_95_share = online->coverage95.value;
    e.singular_share = online->singular_share;
  }
  if (const auto final_poses = stats::consistency({errors.final_poses}, results::kPoseDegreesOfFreedom)) {
    e.anees_final = final_poses->anees.value;
    e.within_50_share_final = final_poses->coverage50.value;
    e.within_95_share_final = final_poses->coverage95.value;
    e.singular_share_final = final_poses->singular_share;
  }
}

Evaluation::Relative relativeConsistency(const results::RunFolder& run, const Truth& truth,
                                         results::RelativeCovariance::Kind kind) {
  const auto known =
      stats::consistency({results::relativeNees(truth.trajectory, run.final_estimate.value_or(run.estimate),
                                                run.relative_covariances, kind)},
                         results::kPoseDegreesOfFreedom);
  return known ? Evaluation::Relative{known->anees.value, known->coverage95.value}
               : Evaluation::Relative{kNaN, kNaN};
}

}  // namespace

Alignment alignmentOf(const resources::Manifest& manifest) {
  Alignment alignment;
  if (manifest.results.count("localised_in") > 0) alignment.how = metrics::Align::kNone;
  return alignment;
}

core::Pose2 mapFrame(const resources::Manifest& manifest, const std::string& map_truth_path) {
  const auto map = manifest.results.find("localised_in");
  if (map == manifest.results.end())
    throw core::InputError(
        "--map-truth: the run was not localised in a map, expected one of 'run --localise'");
  // The map may be a file of the run that made it.
  const std::filesystem::path place(map->second);
  const std::string folder =
      std::filesystem::is_directory(place) ? map->second : place.parent_path().string();
  const auto estimate = logs::readTum(folder + "/trajectory.tum");
  const auto error =
      metrics::trajectoryError(logs::readTrajectory(map_truth_path), estimate, metrics::Align::kFirst);
  if (error.position_m.count == 0)
    throw core::InputError(map_truth_path + ": no stamp in common with " + folder +
                           "/trajectory.tum, expected the truth of the log that the map was made of");
  return error.T_truth_estimate;
}

Evaluation evaluate(const results::RunFolder& run, const std::optional<Truth>& truth,
                    const std::optional<Alignment>& given) {
  const Alignment alignment = given.value_or(alignmentOf(run.manifest));
  Evaluation e = failedEvaluation(run.method, "");
  // The gravest last.
  for (const char* event : {"lost", "interrupted", "failed"}) {
    const auto found = run.manifest.results.find(event);
    if (found != run.manifest.results.end()) e.failure = found->second;
  }
  e.cost = run.cost;
  e.align = alignment.how;
  e.lost_share = results::resultIfThere(run.manifest, "lost_share");
  e.path_length_m = results::resultIfThere(run.manifest, "path_length_m");
  e.end_pose = {results::resultIfThere(run.manifest, "end.x_m"),
                results::resultIfThere(run.manifest, "end.y_m"),
                results::resultIfThere(run.manifest, "end.yaw_rad")};
  // A run that was not made by buildMap() does not say them.
  if (std::isnan(e.path_length_m)) e.path_length_m = core::pathLength(run.estimate);
  if (!core::isFinite(e.end_pose) && !run.estimate.empty()) e.end_pose = run.estimate.back().pose;
  e.map_mean_entropy_bits = results::resultOf(run.manifest, "map_mean_entropy_bits", run.path);
  e.structure = metrics::mapStructure(run.map);
  e.mean_map_entropy = results::resultIfThere(run.manifest, "self.mean_map_entropy");
  e.wall_thickness_m = results::resultIfThere(run.manifest, "self.wall_thickness_m");
  e.on_wall_share = results::resultIfThere(run.manifest, "self.on_wall_share");
  e.through_wall_share = results::resultIfThere(run.manifest, "self.through_wall_share");
  if (!truth) return e;
  std::vector<results::LostSpan> lost;
  if (run.manifest.results.count("localised_in") && std::filesystem::exists(run.path + "/journal.csv") &&
      !run.estimate.empty())
    lost = results::lostSpans(results::readJournal(run.path + "/journal.csv"),
                              run.estimate.back().time_s - run.estimate.front().time_s);
  const auto errorOf = [&](const core::Trajectory& estimate) {
    return metrics::trajectoryError(truth->trajectory, results::whileNotLost(estimate, lost), alignment.how,
                                    alignment.T_truth_map);
  };
  e.trajectory = errorOf(run.estimate);
  e.final_trajectory = run.final_estimate ? errorOf(*run.final_estimate) : e.trajectory;
  e.per_metre = metrics::relativeErrorOverDistance(truth->trajectory, run.estimate, 1.0);
  e.per_second = metrics::relativeErrorOverTime(truth->trajectory, run.estimate, 1.0);
  judgeCovariances(statedErrors(run, *truth, alignment), e);
  using Kind = results::RelativeCovariance::Kind;
  e.relative_1m = relativeConsistency(run, *truth, Kind::kMetre);
  e.relative_10m = relativeConsistency(run, *truth, Kind::kTenMetres);
  e.relative_loop = relativeConsistency(run, *truth, Kind::kLoop);
  if (truth->plan && truth->seen) {
    const core::Pose2& T_world_map = e.final_trajectory.T_truth_estimate;
    e.map = metrics::scoreMap(*truth->plan, *truth->seen, run.map, T_world_map, kWallTolerance_m);
    if (!truth->people.empty())
      e.ghost_share = metrics::ghostShare(*truth->plan, *truth->seen, truth->people, run.map, T_world_map,
                                          kWallTolerance_m);
  }
  return e;
}

namespace {

table::Table tableOf(const std::string& caption, const std::vector<std::string>& keys,
                     const std::vector<Evaluation>& evaluations) {
  table::Table table;
  table.caption = caption;
  table.columns = {{"method", "method", 0}};
  for (const auto& e : evaluations) table.rows.push_back({e.method});
  for (const auto& key : keys) {
    const auto& infos = metricInfos();
    const auto info =
        std::find_if(infos.begin(), infos.end(), [&](const MetricInfo& i) { return i.key == key; });
    if (info == infos.end()) throw core::ContractError("no metric '" + key + "'");
    table.columns.push_back({key, info->title, info->decimals});
    for (size_t i = 0; i < evaluations.size(); ++i) table.rows[i].emplace_back(info->of(evaluations[i]));
  }
  return table;
}

/// What every table of results owes its reader.
table::Table withNotes(table::Table table, const std::vector<Evaluation>& evaluations) {
  table.notes.emplace_back("One run with one seed: small differences between rows may be chance.");
  for (const auto& e : evaluations)
    if (!e.failure.empty()) table.notes.push_back(e.method + " failed: " + e.failure);
  return table;
}

}  // namespace

namespace {

/// What is not the usual alignment has to be said.
void sayAlignment(const std::vector<Evaluation>& evaluations, table::Table& table) {
  for (const auto& e : evaluations)
    if (e.align == metrics::Align::kNone)
      table.notes.push_back(e.method +
                            ": not aligned (align none): errors in the frame of the known map, "
                            "while the robot was not lost.");
    else if (e.align == metrics::Align::kFirst)
      table.notes.push_back(e.method + ": aligned at the first pose (align first).");
}

bool isLocalised(const Evaluation& e) {
  return e.align == metrics::Align::kNone;
}

}  // namespace

table::Table accuracyTable(const std::vector<Evaluation>& evaluations, const Truth& truth, Detail detail) {
  std::vector<std::string> keys = {"ate_rmse_m", "ate_final_m", "heading_rmse_deg", "rpe_1m_m", "rpe_1m_deg"};
  const auto add = [&](std::initializer_list<const char*> more) {
    keys.insert(keys.end(), more.begin(), more.end());
  };
  if (detail == Detail::kFull)
    add({"ate_max_m", "rpe_1s_m", "rpe_1s_deg", "anees", "within_50_share", "within_95_share",
         "singular_share", "anees_final", "within_50_share_final", "within_95_share_final",
         "singular_share_final", "anees_1m", "within_95_share_1m", "anees_10m", "within_95_share_10m",
         "anees_loop", "within_95_share_loop", "path_length_m"});
  if (detail == Detail::kFull || std::any_of(evaluations.begin(), evaluations.end(), isLocalised))
    add({"lost_share"});
  if (truth.plan) add({"wall_f1", "free_iou", "wall_p95_m"});
  if (truth.plan && (detail == Detail::kFull || !truth.people.empty())) add({"ghost_share"});
  if (truth.plan && detail == Detail::kFull)
    add({"wall_p50_m", "wall_precision", "wall_recall", "missed_p50_m", "missed_p95_m", "known_share"});
  if (detail == Detail::kFull)
    add({"wall_thickness_m", "mean_map_entropy", "on_wall_share", "through_wall_share", "map_entropy_bits",
         "occupied_share", "corners", "enclosed_areas"});
  auto table = withNotes(tableOf("Accuracy against ground truth", keys, evaluations), evaluations);
  sayAlignment(evaluations, table);
  return table;
}

table::Table agreementTable(const std::vector<Evaluation>& evaluations, Detail detail) {
  std::vector<std::string> keys = {"path_length_m", "agreement_m",        "wall_thickness_m",
                                   "on_wall_share", "through_wall_share", "occupied_share",
                                   "corners",       "enclosed_areas"};
  if (detail == Detail::kFull)
    for (const char* key : {"mean_map_entropy", "map_entropy_bits", "end_x_m", "end_y_m", "end_yaw_deg"})
      keys.emplace_back(key);
  auto table = withNotes(
      tableOf("No truth is known for this log: what can be said without it", keys, evaluations), evaluations);
  table.notes.emplace_back(
      "Drawing walls twice makes walls thicker and puts fewer returns on them, more beams through them, and "
      "more "
      "occupied cells, corners and areas into the map. None of these shows a global distortion of the map; "
      "the "
      "last three compare maps of one rasteriser only. 'rasterslam list metrics' defines them.");
  return table;
}

table::Table costTable(const std::vector<Evaluation>& evaluations) {
  return tableOf("Cost on this machine", costKeys(), evaluations);
}

void setAgreement(const std::vector<results::RunFolder>& runs, std::vector<Evaluation>& evaluations) {
  for (auto& e : evaluations)
    for (size_t i = 0; i < runs.size(); ++i)
      if (runs[i].method == e.method) e.agreement_m = agreementWithOthers(runs, i);
}

}  // namespace slam::score
