#include "libslam/explore/explore.h"

#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/explore/coverage_charts.h"
#include "libslam/explore/exploration_jobs.h"
#include "libslam/explore/exploration_tables.h"
#include "libslam/explore/loop_localiser.h"
#include "libslam/explore/oracle_files.h"
#include "libslam/files/files.h"
#include "libslam/resources/file_hash.h"
#include "libslam/table/latex.h"
#include "libslam/table/number_text.h"

namespace slam::explore {
namespace fs = std::filesystem;
namespace {

using core::kNaN;
constexpr double kCutOffBelow = 0.9;  // share of the free area; corners out of sight are less than a tenth

void checkRequest(const ExploreRequest& request) {
  if (request.strategies.empty()) throw core::InputError("no strategy named, expected at least one");
  std::set<std::string> names;
  for (const auto& config : request.strategies)
    if (!names.insert(strategyNameOf(config)).second)
      throw core::InputError("strategy '" + strategyNameOf(config) + "' is named twice");
  if (request.seeds < 1 || request.threads < 1)
    throw core::ContractError("explore: seeds and threads from 1");
  if (request.observer && (request.strategies.size() != 1 || request.seeds != 1))
    throw core::ContractError("explore: an observer sees one run");
}

/// What the reader of the tables has to know of one run.
std::vector<std::string> notesOf(const ExplorationJob& job, const ExploreRequest& request) {
  const auto& e = job.result.exploration;
  std::vector<std::string> about;
  if (e.explorable_share < kCutOffBelow)
    about.push_back("From the start only " + table::fixed(100 * e.explorable_share, 0) +
                    " % of the plan's free area can be explored: the rest is cut off from it.");
  if (job.result.plan_is_open)
    about.emplace_back(
        "The plan is open: free space reaches the picture's edge, which stops the robot and gives no "
        "echo.");
  if (job.result.saw_nothing) about.emplace_back("No scan had a single return.");
  if (e.end == ExplorationEnd::kFailed)
    about.push_back(e.strategy + ", seed " + std::to_string(e.seed) + ", failed: " + e.end_detail);
  if (request.seeds == 1 && e.end == ExplorationEnd::kFinished && !e.end_detail.empty())
    about.push_back(e.strategy + " finished: " + e.end_detail + ".");
  for (const auto& carry : job.result.carries)
    about.push_back(e.strategy + (request.seeds > 1 ? ", seed " + std::to_string(e.seed) : "") + ": " +
                    carry + ".");
  return about;
}

void addNotes(const std::vector<ExplorationJob>& jobs, const ExploreRequest& request,
              const LoopMethod& method, table::Table& table) {
  auto& notes = table.notes;
  if (request.seeds > 1)
    notes.push_back("Medians over the seeds " + std::to_string(request.seed) + " to " +
                    std::to_string(request.seed + static_cast<std::uint64_t>(request.seeds) - 1) +
                    ", below them the quartiles. A run that never explores 90 % or 99 % counts as endlessly "
                    "late; '-' where that decides the figure.");
  else
    notes.emplace_back("One run with one seed: small differences between rows may be chance.");
  if (method.is_reference)
    notes.emplace_back("Reference, not a SLAM method: the robot is told its true pose.");
  std::set<std::string> said;
  for (const auto& job : jobs) {
    for (auto& note : notesOf(job, request))
      if (said.insert(note).second) notes.push_back(std::move(note));
  }
}

/// Which oracle a run is scored by: one for all, or where furniture has moved each seed's own.
std::uint64_t oracleOf(const ExploreRequest& request, const ExplorationJob& job) {
  return job.config->record.living.visit > 1 ? job.seed : request.seed;
}

std::map<std::uint64_t, oracle::Oracle> askForAll(const ExploreRequest& request, const world::Plan& plan,
                                                  const std::vector<ExplorationJob>& jobs,
                                                  core::Progress& progress) {
  std::map<std::uint64_t, oracle::Oracle> oracles;
  if (!request.oracle) return oracles;
  progress.begin("asking the oracle about " + plan.name);
  for (const auto& job : jobs) {
    const std::uint64_t key = oracleOf(request, job);
    if (oracles.count(key) == 0)
      oracles[key] =
          askOracle(record::planOfVisit(plan, job.config->record.living, key), *job.config, progress);
  }
  progress.end();
  return oracles;
}

/// Of all runs: those that failed are counted, and their empty folders removed.
void collect(const std::vector<ExplorationJob>& jobs, const std::string& folder, ExplorationReport& result) {
  int kept = 0;
  for (const auto& job : jobs) {
    result.runs.push_back(job.result.exploration);
    if (job.result.exploration.end != ExplorationEnd::kFailed) continue;
    ++result.failed;
    kept += job.folder.empty() || !fs::exists(job.folder + "/manifest.json") ? 0 : 1;
    if (!job.folder.empty() && job.folder != folder && fs::is_empty(job.folder)) fs::remove(job.folder);
  }
  if (result.failed == static_cast<int>(jobs.size()) && kept == 0)
    throw core::MethodError(result.runs.front().end_detail);
}

void writeTables(const ExplorationReport& result, const table::Table& statistics,
                 const std::string& plan_name, const std::string& folder) {
  const auto write = [&](const char* name, const std::string& text) {
    files::writeFileAtomically(folder + "/" + name, text);
  };
  write("scores.txt", table::toText(result.scores));
  write("scores.md", table::toMarkdown(result.scores));
  write("scores.tex", table::toLatex(result.scores, {"tab:scores", bestFigures()}));
  write("scores.csv", table::toCsv(statistics));
  write("scores.json", table::toJson(statistics));
  write("runs.csv", table::toCsv(runsTable(result.runs, plan_name)));
  write("cost.csv", table::toCsv(result.cost));
  write("cost.json", table::toJson(result.cost));
}

/// A single run has already left a manifest there: the same one, with more in it.
void writeManifest(resources::Manifest manifest, const ExplorationReport& result, bool has_curves,
                   bool has_oracle, const std::string& folder) {
  if (fs::exists(folder + "/manifest.json")) manifest = resources::readManifest(folder + "/manifest.json");
  manifest.files["scores.txt"] = "the table; also .md and .tex, and .csv and .json with quartiles";
  manifest.files["runs.csv"] = "every figure of every run";
  if (has_curves)
    manifest.files["curves.csv"] = "explored share over time and path: rasterslam plot exploration";
  manifest.files["coverage.png"] = "explored share over time, path and scans";
  if (has_oracle)
    manifest.files["oracle.csv"] = "tours with the plan in hand: path and share; also _path.csv, .png";
  manifest.files["cost.csv"] = "CPU time of the decisions; also .json";
  manifest.results.emplace("status", "complete");  // a single run that failed has said so
  manifest.results["failed_runs"] = std::to_string(result.failed);
  resources::writeManifest(manifest, folder + "/manifest.json");
}

}  // namespace

const std::string& strategyNameOf(const ExploreConfig& config) {
  return config.own ? config.own->name : config.record.strategy.name;
}

const files::ParameterTable<ExplorationOptions>& ExplorationOptions::table() {
  using O = ExplorationOptions;
  static const files::ParameterTable<O> rows(
      "exploration",
      {{"stuck_s", &O::stuck_s, 60.0, 0.0, 1e7,
        "end after so long without new area and without a new place 1 m away, waits for people apart; 0 = "
        "never"},
       {"give_up_s", &O::give_up_s, 300.0, 0.0, 1e7,
        "end after so long without 0.1 m2 of new area; 0 = never"},
       {"return_to_start", &O::return_to_start, false, "after finishing drive back to the start"}});
  return rows;
}

ExplorationOptions::ExplorationOptions() {
  table().setDefaults(*this);
}

ExploreConfig readExploreConfig(const files::IniFile& ini) {
  ExploreConfig config;
  config.record = record::readRecordConfig(ini, {ExplorationOptions::table().section()});
  files::readParameters(ini, ExplorationOptions::table(), config.exploration, &config.record.parameters);
  return config;
}

Exploration::Exploration() {
  oracle90_m = oracle99_m = below90_m = below99_m = ratio90 = ratio99 = return_distance_m = kNaN;
}

Exploration failedExploration(const ExploreConfig& config, const std::string& slam, std::uint64_t seed,
                              const std::string& why) {
  Exploration e;
  e.strategy = strategyNameOf(config);
  e.slam = slam;
  e.seed = seed;
  e.end_detail = why;
  e.figures = metrics::explorationFigures({}, 0);
  e.figures.time_s = e.figures.path_m = e.explorable_m2 = e.explorable_share = kNaN;
  e.collisions = e.near_misses = e.decisions = e.revisits = kNaN;
  e.decision_mean_ms = e.decision_max_ms = kNaN;
  e.evaluation = score::failedEvaluation(slam, why);
  return e;
}

std::string endName(ExplorationEnd end) {
  switch (end) {
    case ExplorationEnd::kFinished:
      return "finished";
    case ExplorationEnd::kDuration:
      return "duration";
    case ExplorationEnd::kStuck:
      return "stuck";
    case ExplorationEnd::kGaveUp:
      return "gave up";
    case ExplorationEnd::kFailed:
      return "failed";
  }
  throw core::ContractError("endName: no such end");
}

ExplorationReport explore(const ExploreRequest& request, resources::Manifest manifest,
                          core::Progress& progress) {
  checkRequest(request);
  const auto method = loadMethod(request.slam, request.methods_folder);
  const auto plan = world::loadPlan(request.plan_path);
  files::PendingFolder output(request.output, request.overwrite);
  const std::string folder = output.path();
  manifest.seed = request.seed;
  manifest.inputs[request.plan_path] = resources::fileSha256(request.plan_path);

  auto jobs = makeJobs(request, folder);
  const auto oracles = askForAll(request, plan, jobs, progress);
  progress.begin("exploring " + plan.name);
  runJobs(jobs, plan, method, request.threads, manifest, progress, request.observer);
  progress.end();
  for (auto& job : jobs)
    if (request.oracle) compareWith(oracles.at(oracleOf(request, job)), job.result.exploration);

  ExplorationReport result;
  collect(jobs, folder, result);
  const std::string caption = "Exploration of " + plan.name + " with " +
                              (method.is_reference ? "the true pose (reference)" : method.name);
  const auto groups = byStrategy(result.runs, request.seeds);
  result.scores = scoresTable(groups, caption, request.oracle);
  addNotes(jobs, request, method, result.scores);
  const oracle::Oracle* const first = oracles.empty() ? nullptr : &oracles.at(request.seed);
  if (first) result.scores.notes.push_back(oracleNote(*first));
  auto statistics = statisticsTable(groups, plan.name);
  statistics.caption = caption;
  statistics.notes = result.scores.notes;
  result.cost = costTable(result.runs);
  writeTables(result, statistics, plan.name, folder);
  if (first) {
    const auto& living = request.strategies.front().record.living;
    writeOracle(*first, record::planOfVisit(plan, living, request.seed), folder);
  }
  drawCoverage(jobs, first, caption, folder + "/coverage.png");
  if (request.tables_only) files::writeFileAtomically(folder + "/curves.csv", curvesCsv(jobs));
  writeManifest(std::move(manifest), result, request.tables_only, first != nullptr, folder);
  output.commit();
  return result;
}

}  // namespace slam::explore
