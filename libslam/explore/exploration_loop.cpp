#include "libslam/explore/exploration_loop.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "libslam/core/error.h"
#include "libslam/core/files.h"
#include "libslam/explore/decision_log.h"
#include "libslam/explore/exploration_referee.h"
#include "libslam/explore/loop_localiser.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/navigate/driver.h"
#include "libslam/navigate/return_to_start.h"
#include "libslam/pictures/picture.h"
#include "libslam/process/cpu_time.h"
#include "libslam/record/carry_file.h"
#include "libslam/record/recorder.h"
#include "libslam/record/sensor.h"
#include "libslam/run/build_map.h"
#include "libslam/run/log_feed.h"
#include "libslam/run/manifest_entries.h"
#include "libslam/run/map_plan.h"
#include "libslam/run/scene_file.h"
#include "libslam/run/stopped_run.h"

namespace slam::explore {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr int kReturnDecisions = 50;  // a way back through a known map takes a few

/// CPU time of the periods in which the robot decided, the map's reading included.
struct DecisionCost {
  double total_ms = 0, max_ms = 0;
};

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

/// The loop's state, scan by scan.
class Loop {
 public:
  Loop(const world::Plan& plan, const ExploreConfig& config, const LoopMethod& method, std::uint64_t seed,
       const std::string& folder)
      : plan_(plan),
        config_(config),
        method_(method),
        seed_(seed),
        folder_(folder),
        start_(record::startPose(plan, config.record)),
        radius_m_(robot::circumscribedRadius(config.record.robot)),
        simulator_(plan, config.record.robot, config.record.lidar, config.record.odometry, start_, seed,
                   sim::Simulator::kStartTime_s, config.record.living, config.record.camera),
        localiser_(method, seed),
        driver_(makeDriver()),
        coverage_(plan, metrics::explorableArea(plan, core::position(start_), radius_m_,
                                                config.record.lidar.max_range_m)),
        referee_(config.exploration),
        near_misses_(plan, radius_m_) {
    simulator_.carryAt(config.record.carries);
    for (const auto& lidar : config.record.other_lidars) simulator_.mount(lidar, seed);
    if (!folder.empty()) recorder_.emplace(folder + "/run.rawlog", config.record);
  }

  /// A method that fails on the way ends the run; what it had mapped stays.
  void run(core::Progress& progress, record::StepObserver* observer) {
    try {
      explore(progress, observer);
    } catch (const core::MethodError& error) {
      if (estimate_.empty()) throw;
      stop_ = {run::Stop::Reason::kFailed, static_cast<int>(estimate_.size()),
               simulator_.time_s() - start_time_s_, error.what()};
      end_ = ExplorationEnd::kFailed;
      end_detail_ = run::stopText(*stop_);
    }
  }

  LoopResult result() const;
  void writeFiles(LoopResult& result, core::Manifest manifest);

 private:
  void explore(core::Progress& progress, record::StepObserver* observer) {
    start_time_s_ = simulator_.time_s();
    const double duration_s = config_.record.simulation.duration_s;
    sim::Sensed sensed = simulator_.sense();
    if (recorder_) recorder_->begin(simulator_, sensed);
    while (true) {
      // The clock counts nanoseconds, but since the epoch a double is good for a quarter of a microsecond.
      const double elapsed_s = std::round((simulator_.time_s() - start_time_s_) * 1e6) / 1e6;
      progress.update(duration_s > 0 ? elapsed_s / duration_s : 1, elapsed_s);
      const core::Pose2 T_map_robot = localiser_.update(sensed, simulator_.truth());
      look(sensed, T_map_robot, elapsed_s);
      if (elapsed_s + period_s() / 2 >= duration_s) return end(ExplorationEnd::kDuration);
      if (const auto verdict = referee_.judge(elapsed_s, coverage_.area_m2(), simulator_.truth()))
        return end(*verdict);
      const robot::Command command = decide(sensed, T_map_robot, elapsed_s);
      if (observer)
        observer->onStep({elapsed_s, sensed.scan, sensed.T_previous_robot, T_map_robot, &localiser_.builder(),
                          &simulator_, &driver_->currentDecision()});
      goals_.push_back(goalInMap(decisions_.back()));
      if (driver_->finished()) {
        end(ExplorationEnd::kFinished);
        if (returning_ || !config_.exploration.return_to_start) return;
        returning_ = true;
        driver_ = makeReturnDriver();
        referee_.watchReturn();
      }
      localiser_.tell(command);
      sensed = simulator_.step(command);
      if (recorder_) recorder_->add(command, simulator_, sensed);
    }
  }

  double period_s() const { return 1 / config_.record.lidar.rate_hz; }

  std::unique_ptr<navigate::Driver> makeDriver() const {
    const auto& record = config_.record;
    const core::RandomStream random(seed_, "strategy");
    auto strategy = config_.own ? config_.own->make(record.strategy, random)
                                : navigate::makeStrategy(record.strategy, random);
    return std::make_unique<navigate::Driver>(std::move(strategy), record.strategy, record.robot, period_s(),
                                              core::RandomStream(seed_, "driver"));
  }
  std::unique_ptr<navigate::Driver> makeReturnDriver() const {
    auto options = config_.record.strategy;
    options.give_up_after = kReturnDecisions;  // the map does not grow on the way back
    return std::make_unique<navigate::Driver>(
        std::make_unique<navigate::ReturnToStart>(options, config_.record.robot), options,
        config_.record.robot, period_s(), core::RandomStream(seed_, "return"));
  }

  /// What the truth has to say about the new scan.
  void look(const sim::Sensed& sensed, const core::Pose2& T_map_robot, double elapsed_s) {
    const auto& scan = sensed.scan;
    const auto& T_world_robot = simulator_.truth();
    if (!first_scan_) first_scan_ = scan;
    last_scan_ = scan;
    path_.add(T_world_robot, simulator_.carries());
    truth_.push_back({simulator_.time_s(), T_world_robot});
    estimate_.push_back({scan.time_s, T_map_robot});
    const auto [first_angle_rad, beams] = record::beamsOverFloor(config_.record.camera, scan);
    coverage_.look(T_world_robot * scan.T_robot_lidar, first_angle_rad, scan.step_rad, beams,
                   scan.max_range_m);
    curve_.push_back({elapsed_s, path_.length_m(), truth_.size(), coverage_.area_m2()});
    near_misses_.look(T_world_robot);
    saw_something_ = saw_something_ || std::any_of(scan.ranges_m.begin(), scan.ranges_m.end(),
                                                   [](float range) { return robot::isReturn(range); });
  }

  robot::Command decide(const sim::Sensed& sensed, const core::Pose2& T_map_robot, double elapsed_s) {
    const double before_s = process::threadCpuSeconds();
    if (driver_->wantsMap()) {
      const auto map = localiser_.map();
      driver_->setMap(map);
    }
    const auto command = driver_->next(sensed.scan, T_map_robot, sensed.collided);
    const auto& decision = driver_->currentDecision();
    if (decisions_.empty() || !isSame(decision, decisions_.back().decision)) {
      decisions_.push_back({elapsed_s, T_map_robot, simulator_.truth(), decision});
      const double ms = (process::threadCpuSeconds() - before_s) * 1000;
      decision_cost_.total_ms += ms;
      decision_cost_.max_ms = std::max(decision_cost_.max_ms, ms);
    }
    return command;
  }

  /// The first end counts: what happens on the way back is no part of the exploration.
  void end(ExplorationEnd end) {
    if (end_ != ExplorationEnd::kFailed) return;
    end_ = end;
    if (end == ExplorationEnd::kFinished) end_detail_ = driver_->currentDecision().reason;
    explored_scans_ = curve_.size();
  }
  table::Table explorationTable() const;
  bool writeMap(const Exploration& e);
  void drawPath(const Exploration& e) const;
  void describeResults(const Exploration& e, bool has_map, core::Manifest& manifest) const;

  const world::Plan& plan_;
  const ExploreConfig& config_;
  const LoopMethod& method_;
  std::uint64_t seed_;
  std::string folder_;
  core::Pose2 start_;
  double radius_m_;
  sim::Simulator simulator_;
  Localiser localiser_;
  DecisionCost decision_cost_;
  std::unique_ptr<navigate::Driver> driver_;
  metrics::Coverage coverage_;
  Referee referee_;
  NearMisses near_misses_;
  std::optional<record::Recorder> recorder_;

  std::optional<robot::Scan> first_scan_, last_scan_;
  core::Trajectory truth_, estimate_;
  std::vector<metrics::CoveragePoint> curve_;
  std::vector<core::Point2> goals_;  ///< after every scan, map frame; none for the last when it ended there
  std::vector<DecisionEntry> decisions_;
  sim::DrivenPath path_;
  bool saw_something_ = false;
  bool returning_ = false;
  ExplorationEnd end_ = ExplorationEnd::kFailed;
  std::string end_detail_;
  std::size_t explored_scans_ = 0;  ///< what follows is the way back
  double start_time_s_ = 0;
  std::optional<run::Stop> stop_;
};

LoopResult Loop::result() const {
  LoopResult result;
  if (end_ == ExplorationEnd::kFailed) {
    result.exploration = failedExploration(config_, method_.name, seed_, end_detail_);
    return result;
  }
  Exploration& e = result.exploration;
  const auto& area = coverage_.explorable();
  e.strategy = strategyNameOf(config_);
  e.slam = method_.name;
  e.seed = seed_;
  e.end = end_;
  e.end_detail = end_detail_;
  result.curve.assign(curve_.begin(), curve_.begin() + static_cast<std::ptrdiff_t>(explored_scans_));
  e.figures = metrics::explorationFigures(result.curve, area.area_m2);
  e.explorable_m2 = area.area_m2;
  e.explorable_share = area.share_of_free;
  e.collisions = static_cast<double>(simulator_.collisions().size());
  e.near_misses = near_misses_.count();
  e.decisions = static_cast<double>(decisions_.size());
  e.return_distance_m = returning_ ? core::distance(simulator_.truth(), start_) : kNaN;
  e.decision_mean_ms =
      decisions_.empty() ? kNaN : decision_cost_.total_ms / static_cast<double>(decisions_.size());
  e.decision_max_ms = decisions_.empty() ? kNaN : decision_cost_.max_ms;

  const auto raster = localiser_.map();
  run::RunFolder run;
  run.method = method_.name;
  run.estimate = estimate_;
  run.map = run::toPlan(raster);
  run.manifest.results["map_mean_entropy_bits"] = core::formatNumber(metrics::mapEntropy(raster.occupancy));
  score::Truth truth;
  truth.trajectory = truth_;
  truth.plan = plan_;
  truth.seen = coverage_.seen();
  e.evaluation = score::evaluate(run, truth);

  result.plan_is_open = opensToTheEdge(area);
  result.saw_nothing = !saw_something_;
  for (const auto& carry : simulator_.carries())
    result.carries.push_back(record::carryText(carry, sim::Simulator::kStartTime_s));
  if (simulator_.waitingCarries() > 0)
    result.carries.push_back(std::to_string(simulator_.waitingCarries()) +
                             " of the carries came after the end");
  return result;
}

table::Table Loop::explorationTable() const {
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
bool Loop::writeMap(const Exploration& e) {
  try {
    localiser_.map();
  } catch (const core::MethodError&) {
    mapping::saveKeyFrames(localiser_.builder(), folder_);
    return false;
  }
  mapping::saveMaps(localiser_.builder(), folder_);
  run::writeScene(localiser_.builder(), estimate_, *last_scan_, folder_ + "/map.3Dscene");
  if (e.end != ExplorationEnd::kFailed && core::isFinite(e.evaluation.trajectory.T_truth_estimate))
    run::addTruthToScene(truth_, &plan_, core::inverse(e.evaluation.trajectory.T_truth_estimate),
                         folder_ + "/map.3Dscene");
  return true;
}

void Loop::drawPath(const Exploration& e) const {
  pictures::DrawnMarks marks{{}, "decision"};
  for (const auto& entry : decisions_) marks.places.push_back(core::position(entry.T_world_robot));
  core::Trajectory believed = estimate_;
  // Of a run that failed nothing was laid on the truth: its path is shown from the true start.
  const core::Pose2 T_truth_estimate = e.end == ExplorationEnd::kFailed
                                           ? start_ * core::inverse(estimate_.front().pose)
                                           : e.evaluation.trajectory.T_truth_estimate;
  for (auto& stamped : believed) stamped.pose = T_truth_estimate * stamped.pose;
  pictures::drawPlan(plan_,
                     {{record::brokenAtCarries(truth_, simulator_.carries()), "true path", true},
                      {believed, "path as " + method_.name + " has it"}},
                     plan_.name + ": " + e.strategy, folder_ + "/path.png", marks);
}

void Loop::describeResults(const Exploration& e, bool has_map, core::Manifest& manifest) const {
  auto& results = manifest.results;
  run::describeLidar(*first_scan_, results);
  run::describeSensors(localiser_.builder(), lidarsOf(config_.record), results);
  const auto number = [](double value) { return core::formatNumber(value); };
  results["method"] = method_.name;
  results["strategy"] = e.strategy;
  results["end"] = endName(e.end);
  if (e.end == ExplorationEnd::kFailed) {
    results["status"] = "incomplete";
    results["failed"] = e.end_detail;
    const std::vector<core::JournalLine> journal = {run::stopLine(*stop_, estimate_.back().pose)};
    core::writeFileAtomically(folder_ + "/journal.csv", run::journalCsv(journal));
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

void Loop::writeFiles(LoopResult& result, core::Manifest manifest) {
  const auto& e = result.exploration;
  recorder_->finish(simulator_, seed_, manifest);
  logs::writeTum(estimate_, folder_ + "/trajectory.tum");
  const bool has_map = writeMap(e);
  core::writeFileAtomically(folder_ + "/exploration.csv", table::toCsv(explorationTable()));
  core::writeFileAtomically(folder_ + "/decisions.csv", table::toCsv(decisionTable(decisions_)));
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
  core::writeManifest(manifest, folder_ + "/manifest.json");
}

}  // namespace

LoopResult exploreOnce(const world::Plan& given_plan, const ExploreConfig& config, const LoopMethod& method,
                       std::uint64_t seed, const std::string& folder, core::Manifest manifest,
                       core::Progress& progress, record::StepObserver* observer) {
  const world::Plan plan = record::planOfVisit(given_plan, config.record.living, seed);
  Loop loop(plan, config, method, seed, folder);
  loop.run(progress, observer);
  LoopResult result = loop.result();
  if (!folder.empty()) loop.writeFiles(result, std::move(manifest));
  return result;
}

}  // namespace slam::explore
