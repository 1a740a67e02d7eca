#include <algorithm>
#include <cmath>

#include "libslam/core/numbers.h"
#include "libslam/explore/exploring_robot.h"
#include "libslam/files/files.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/pictures/picture.h"
#include "libslam/results/manifest_entries.h"
#include "libslam/results/map_cells.h"
#include "libslam/results/scene_file.h"
#include "libslam/run/build_map.h"
#include "libslam/run/log_feed.h"
#include "libslam/truth/carry_file.h"

namespace slam::explore {
namespace {

using core::kNaN;

std::vector<std::string> lidarsOf(const record::RecordConfig& record) {
  std::vector<std::string> labels = {"LASER"};
  for (const auto& lidar : record.other_lidars) labels.push_back(lidar.label);
  return labels;
}

bool opensToTheEdge(const metrics::ExplorableArea& area) {
  for (int row = 0; row < area.rows; ++row)
    for (int column = 0; column < area.columns; ++column) {
      const bool at_edge = row == 0 || column == 0 || row + 1 == area.rows || column + 1 == area.columns;
      if (at_edge && area.explorable[static_cast<size_t>(row) * static_cast<size_t>(area.columns) +
                                     static_cast<size_t>(column)])
        return true;
    }
  return false;
}

}  // namespace

/// Map and path at the end.
void ExploringRobot::score(Exploration& e) const {
  const auto raster = localiser_.map();
  results::RunFolder run;
  run.method = method_.name;
  run.estimate = estimate_;
  run.map = results::toCellMap(raster);
  run.manifest.results["map_mean_entropy_bits"] = files::formatNumber(metrics::mapEntropy(raster.occupancy));
  score::Truth truth;
  truth.trajectory = truth_;
  truth.plan = plan_;
  truth.seen = coverage_.seen();
  e.evaluation = score::evaluate(run, truth);
}

LoopResult ExploringRobot::result() const {
  LoopResult result;
  if (end_ == ExplorationEnd::kFailed) {
    result.exploration = failedExploration(config_, method_.name, seed_, end_detail_);
    return result;
  }
  result.curve.assign(curve_.begin(), curve_.begin() + static_cast<std::ptrdiff_t>(explored_scans_));
  Exploration& e = result.exploration;
  const auto& area = coverage_.explorable();
  e.strategy = strategyNameOf(config_);
  e.slam = method_.name;
  e.seed = seed_;
  e.end = end_;
  e.end_detail = end_detail_;
  e.figures = metrics::explorationFigures(result.curve, area.area_m2);
  e.explorable_m2 = area.area_m2;
  e.explorable_share = area.share_of_free;
  e.collisions = static_cast<double>(simulator_.collisions().size());
  e.near_misses = near_misses_.count();
  e.decisions = static_cast<double>(decisions_.size());
  e.revisits =
      static_cast<double>(std::count_if(decisions_.begin(), decisions_.end(), [](const DecisionEntry& entry) {
        return entry.decision.certainty_m > 0;
      }));
  e.return_distance_m = returning_ ? core::distance(simulator_.truth(), start_) : kNaN;
  e.decision_mean_ms = decisions_.empty() ? kNaN : decisions_ms_ / static_cast<double>(decisions_.size());
  e.decision_max_ms = decisions_.empty() ? kNaN : slowest_decision_ms_;

  score(e);
  result.plan_is_open = opensToTheEdge(area);
  result.saw_nothing = !saw_something_;
  for (const auto& carry : simulator_.carries())
    result.carries.push_back(truth::carryText(carry, sim::Simulator::kStartTime_s));
  if (simulator_.waitingCarries() > 0)
    result.carries.push_back(std::to_string(simulator_.waitingCarries()) +
                             " of the carries came after the end");
  return result;
}

table::Table ExploringRobot::explorationTable() const {
  table::Table table;
  for (const char* key :
       {"time_s", "path_m", "scans", "explored_m2", "explored_share", "true_x_m", "true_y_m", "true_yaw_rad",
        "map_x_m", "map_y_m", "map_yaw_rad", "goal_x_m", "goal_y_m"})
    table.columns.push_back({key, key, 3});
  const double explorable_m2 = coverage_.explorable().area_m2;
  for (size_t i = 0; i < curve_.size(); ++i) {
    const auto& point = curve_[i];
    const auto& truth = truth_[i].pose;
    const auto& estimate = estimate_[i].pose;
    const core::Point2 goal = i < goals_.size() ? goals_[i] : core::Point2{kNaN, kNaN};
    table.rows.push_back({point.time_s, point.path_m, static_cast<double>(point.scans), point.explored_m2,
                          explorable_m2 > 0 ? point.explored_m2 / explorable_m2 : kNaN, truth.x, truth.y,
                          truth.phi, estimate.x, estimate.y, estimate.phi, goal.x, goal.y});
  }
  return table;
}

/// False: the map has come apart and cannot be drawn; all else is kept.
bool ExploringRobot::writeMap(const Exploration& e) {
  gridmap::OccupancyRaster map;
  try {
    map = localiser_.map();
  } catch (const core::MethodError&) {
    mapping::saveKeyFrames(localiser_.builder(), folder_);
    return false;
  }
  mapping::saveMaps(localiser_.builder(), map, folder_);
  results::writeScene(localiser_.builder(), map, estimate_, *last_scan_, folder_ + "/map.3Dscene");
  if (e.end != ExplorationEnd::kFailed && core::isFinite(e.evaluation.trajectory.T_truth_estimate))
    results::addTruthToScene(truth_, &plan_, core::inverse(e.evaluation.trajectory.T_truth_estimate),
                             folder_ + "/map.3Dscene");
  return true;
}

void ExploringRobot::drawPath(const Exploration& e) const {
  pictures::DrawnMarks marks{{}, "decision"};
  for (const auto& entry : decisions_) marks.places.push_back(core::position(entry.T_world_robot));
  core::Trajectory believed = estimate_;
  // Of a run that failed nothing was laid on the truth: its path is shown from the true start.
  const core::Pose2 T_truth_estimate = e.end == ExplorationEnd::kFailed
                                           ? start_ * core::inverse(estimate_.front().pose)
                                           : e.evaluation.trajectory.T_truth_estimate;
  for (auto& stamped : believed) stamped.pose = T_truth_estimate * stamped.pose;
  pictures::drawMap(plan_,
                    {{truth::brokenAtCarries(truth_, simulator_.carries()), "true path", true},
                     {believed, "path as " + method_.name + " has it"}},
                    plan_.name + ": " + e.strategy, folder_ + "/path.png", marks);
}

void ExploringRobot::describeResults(const Exploration& e, bool has_map,
                                     resources::Manifest& manifest) const {
  auto& results = manifest.results;
  results::describeLidar(*first_scan_, results);
  run::describeSensors(localiser_.builder(), lidarsOf(config_.record), results);
  const auto number = [](double value) { return files::formatNumber(value); };
  results["method"] = method_.name;
  results["strategy"] = e.strategy;
  results["end"] = endName(e.end);
  if (e.end == ExplorationEnd::kFailed) {
    results["status"] = "incomplete";
    results["failed"] = e.end_detail;
    const std::vector<core::JournalLine> journal = {results::stopLine(*stop_, estimate_.back().pose)};
    files::writeFileAtomically(folder_ + "/journal.csv", results::journalCsv(journal));
    manifest.files["journal.csv"] = "what failed, where";
  }
  results["end_detail"] = e.end_detail;
  results["scans"] = std::to_string(estimate_.size());
  results["steps_without_odometry"] = "0";
  results["explorable_m2"] = number(e.explorable_m2);
  results["coverage"] = number(e.figures.coverage);
  if (has_map) results["map_mean_entropy_bits"] = number(metrics::mapEntropy(localiser_.map().occupancy));
  results["peak_memory_mb"] = "nan";  // of a process that does more than this run
  if (std::isfinite(e.decision_mean_ms)) {
    manifest.times_s["decision_mean"] = e.decision_mean_ms / 1000;
    manifest.times_s["decision_max"] = e.decision_max_ms / 1000;
  }
}

void ExploringRobot::writeFiles(LoopResult& result, resources::Manifest manifest) {
  const auto& e = result.exploration;
  recorder_->finish(simulator_, seed_, manifest);
  logs::writeTum(estimate_, folder_ + "/trajectory.tum");
  const bool has_map = writeMap(e);
  files::writeFileAtomically(folder_ + "/exploration.csv", table::toCsv(explorationTable()));
  files::writeFileAtomically(folder_ + "/decisions.csv", table::toCsv(decisionTable(decisions_)));
  drawPath(e);

  manifest.seed = seed_;
  for (const auto& line : config_.record.parameters)
    manifest.config[line.section + "." + line.info.key] = line.value;
  for (const auto& line : localiser_.builder().parameters)
    manifest.config["slam." + line.section + "." + line.info.key] = line.value;
  manifest.files["run.rawlog"] = "what the robot sensed, with its truth beside it: rasterslam compare";
  manifest.files["trajectory.tum"] = "estimated pose of every scan, TUM form: rasterslam eval, evo";
  if (has_map) manifest.files["map.yaml"] = "the map, also as .png, .gridmap.gz, .simplemap and .3Dscene";
  manifest.files["exploration.csv"] = "after every scan: time, path, explored area, poses, goal";
  manifest.files["decisions.csv"] = "every decision: time, pose, goal, score, reason";
  manifest.files["path.png"] = "true path and places of the decisions on the plan";
  describeResults(e, has_map, manifest);
  resources::writeManifest(manifest, folder_ + "/manifest.json");
}

}  // namespace slam::explore
