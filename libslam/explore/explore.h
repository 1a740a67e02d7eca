#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libslam/core/progress.h"
#include "libslam/files/ini.h"
#include "libslam/files/parameters.h"
#include "libslam/metrics/coverage.h"
#include "libslam/record/record.h"
#include "libslam/record/step_observer.h"
#include "libslam/resources/manifest.h"
#include "libslam/score/evaluate.h"
#include "libslam/table/table.h"

namespace slam::explore {

/// Section [exploration]: the referee, who knows the truth and ends what leads nowhere; and what the robot
/// does when it has finished.
struct ExplorationOptions {
  double stuck_s;        ///< end after so long without new area and without a new place; 0 = never
  double give_up_s;      ///< end after so long without new area; 0 = never
  bool return_to_start;  ///< after finishing drive back through the map that it made
  ExplorationOptions();
  static const files::ParameterTable<ExplorationOptions>& table();
};

/// A strategy that is not one of the library's: its name in tables and folders, and what makes it, as
/// strategies::makeStrategy() does.
struct OwnStrategy {
  std::string name;
  std::function<std::unique_ptr<strategies::Strategy>(const strategies::StrategyOptions&, core::RandomStream)>
      make;
};

struct ExploreConfig {
  record::RecordConfig record;
  ExplorationOptions exploration;
  std::optional<OwnStrategy> own;  ///< decides in place of record.strategy.name
};
/// The name in tables and folders.
const std::string& strategyNameOf(const ExploreConfig& config);
/// Reads the sections of readRecordConfig() and [exploration]; strict. record.parameters has them all.
ExploreConfig readExploreConfig(const files::IniFile& config);

/// The name that takes the place of a SLAM method for the reference: the pose is the true one and the map is
/// drawn from there by the exact grid. What a strategy can do when nothing goes wrong with the estimate; in
/// every table it says so. Only this room can do that: the strategy still sees a pose and a map like any
/// other.
inline constexpr const char* kTruthReference = "truth";

struct ExploreRequest {
  std::string plan_path;
  std::vector<ExploreConfig> strategies;  ///< one row each; they differ in strategyNameOf() at least
  std::string slam;                       ///< a name in methods_folder, the path of an .ini, or "truth"
  std::string methods_folder;
  std::string output;
  std::uint64_t seed = 1;
  int seeds = 1;             ///< runs with seed, seed + 1, ...
  int threads = 1;           ///< runs side by side; the results do not depend on it
  bool oracle = false;       ///< score against tours of somebody who knows the plan too
  bool tables_only = false;  ///< no folder per run, but curves.csv of all of them: sweeps
  bool overwrite = false;
  record::StepObserver* observer = nullptr;  ///< of a single run: one strategy, one seed (ContractError)
};

/// How an exploration ended.
enum class ExplorationEnd {
  kFinished,  ///< the strategy says that nothing is left
  kDuration,  ///< [simulation] duration_s was over
  kStuck,     ///< no new area and no new place for [exploration] stuck_s
  kGaveUp,    ///< no new area for [exploration] give_up_s
  kFailed     ///< the SLAM method failed
};
std::string endName(ExplorationEnd end);

/// Keys of the figures in the tables and what they mean: `rasterslam list metrics`.
const std::vector<std::pair<std::string, std::string>>& explorationFigureInfos();

/// One exploration, scored on the truth.
struct Exploration {
  std::string strategy, slam;
  std::uint64_t seed = 0;
  ExplorationEnd end = ExplorationEnd::kFailed;
  std::string end_detail;  ///< the strategy's own words when finished, why the method failed, or ""
  metrics::ExplorationFigures figures{};
  double explorable_m2 = 0, explorable_share = 0;  ///< the share is of the plan's free cells
  double collisions = 0;
  /// Episodes in which the clearance round the robot's true disc, at the scans, falls below kNearMiss_m and
  /// then rises above kNearMissOver_m.
  double near_misses = 0;
  double decisions = 0;
  double revisits = 0;  ///< of these the ones to go back for a loop: [strategy] revisit
  /// Metres that tours with the plan in hand need (see oracle::Oracle), what no path can be shorter than, and
  /// the competitive ratios: this path to theirs. NaN when nobody asked, or where that share was never
  /// reached.
  double oracle90_m, oracle99_m, below90_m, below99_m, ratio90, ratio99;
  double return_distance_m = 0;  ///< true distance to the start after returning; NaN without. The way back
                                 ///< counts for collisions, near misses, decisions, map and ATE only
  score::Evaluation evaluation;  ///< map and path at the end
  double decision_mean_ms = 0, decision_max_ms = 0;  ///< CPU time
  Exploration();
};
inline constexpr double kNearMiss_m = 0.05, kNearMissOver_m = 0.10;

/// The closed loop: the simulator senses, the method M estimates map and pose, the strategy decides from
/// these alone, the simulator moves. Writes into `output`, which appears whole or not at all:
///   scores.txt .md .tex .csv .json   one row per run (one seed) or per strategy (medians over the seeds)
///   runs.csv                    one row per run
///   coverage.png                explored share over time, path and scans, one line per run
///   oracle.csv _path.csv .png   with `oracle`: the tours of somebody who knows the plan, of the first seed's
///                               plan
///   cost.csv .json              CPU time per decision: differs from run to run
///   manifest.json               how to make it again
/// and for every run, in `output` itself when there is one, else in STRATEGY/ or STRATEGY/seed_N/:
///   run.rawlog run.rawlog.GT.txt run.gt.tum run.operations.txt run.manifest.json   as record() writes them
///   map.* trajectory.tum        as buildMap() writes them
///   exploration.csv             after every scan: time, path, explored area, pose, goal
///   decisions.csv               every decision: time, pose, goal, score, reason
///   path.png                    true path and places of the decisions on the plan
///
/// All of it is the same for the same plan, config and seed, but for cost.* and the times in the manifests.
/// Errors: InputError (plan, config, start, an output that exists). A method that fails on the way gives a
/// row that says so and where, and a folder with what it had mapped (manifest: status = incomplete;
/// journal.csv); the other runs go on. MethodError when every run failed at its first scan.
struct ExplorationReport {
  std::vector<Exploration> runs;  ///< strategies in their order, seeds within
  table::Table scores;            ///< for people
  table::Table cost;
  int failed = 0;
};
/// The row of a run whose method failed: every figure NaN.
Exploration failedExploration(const ExploreConfig& config, const std::string& slam, std::uint64_t seed,
                              const std::string& why);
ExplorationReport explore(const ExploreRequest& request, resources::Manifest manifest,
                          core::Progress& progress);

}  // namespace slam::explore
