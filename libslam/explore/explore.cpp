#include "libslam/explore/explore.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <filesystem>
#include <limits>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "libslam/core/error.h"
#include "libslam/core/files.h"
#include "libslam/core/ini_yaml.h"
#include "libslam/explore/exploration_loop.h"
#include "libslam/explore/oracle_files.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/report/curves.h"
#include "libslam/report/table_latex.h"

namespace slam::explore {
namespace fs = std::filesystem;
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kCutOffBelow = 0.9;  // share of the free area; corners out of sight are less than a tenth
constexpr double kInfinity = std::numeric_limits<double>::infinity();

LoopMethod loadMethod(const ExploreRequest& request) {
  LoopMethod method;
  method.is_reference = request.slam == kTruthReference;
  // The method that believes its wheels, for perfect wheels.
  const std::string name = method.is_reference ? "naive_wheel" : request.slam;
  method.config = mapping::loadMethodConfig(request.methods_folder, name);
  method.name = core::isConfigFile(name) ? fs::path(name).stem().string() : name;
  if (method.is_reference) method.name = kTruthReference;
  mapping::readMethodConfig(method.config);  // a bad key must not show in every run
  return method;
}

struct Job {
  const ExploreConfig* config = nullptr;
  std::uint64_t seed = 0;
  std::string folder;  ///< "" = no files
  LoopResult result;
};

/// Progress of runs side by side as one bar.
class SharedProgress {
 public:
  SharedProgress(core::Progress& whole, size_t runs) : whole_(whole), runs_(runs) {}

  class OfOneRun : public core::Progress {
   public:
    explicit OfOneRun(SharedProgress& shared) : shared_(shared) {}
    void update(double fraction, double log_time_s) override {
      shared_.add(std::clamp(fraction, 0.0, 1.0) - fraction_, log_time_s - log_time_s_);
      fraction_ = std::clamp(fraction, 0.0, 1.0);
      log_time_s_ = log_time_s;
    }
    void finish() { shared_.add(1 - fraction_, 0); }

   private:
    SharedProgress& shared_;
    double fraction_ = 0, log_time_s_ = 0;
  };

 private:
  void add(double fraction, double log_time_s) {
    double done = 0, time_s = 0;
    {
      const std::lock_guard lock(mutex_);
      done = done_ += fraction;
      time_s = log_time_s_ += log_time_s;
    }
    whole_.update(done / static_cast<double>(runs_), time_s);
  }

  core::Progress& whole_;
  std::mutex mutex_;
  size_t runs_;
  double done_ = 0, log_time_s_ = 0;
};

void runJob(Job& job, const world::Plan& plan, const LoopMethod& method, const core::Manifest& manifest,
            core::Progress& progress, record::StepObserver* observer) {
  if (!job.folder.empty()) fs::create_directories(job.folder);
  try {
    job.result = exploreOnce(plan, *job.config, method, job.seed, job.folder, manifest, progress, observer);
  } catch (const core::MethodError& error) {
    job.result.exploration = failedExploration(*job.config, method.name, job.seed, error.what());
  }
}

/// Each run is independent, so the number of threads changes nothing but the time.
void runJobs(std::vector<Job>& jobs, const world::Plan& plan, const LoopMethod& method, int thread_count,
             const core::Manifest& manifest, core::Progress& progress, record::StepObserver* observer) {
  SharedProgress shared(progress, jobs.size());
  std::atomic<size_t> next{0};
  std::vector<std::exception_ptr> errors(jobs.size());
  const auto work = [&] {
    for (size_t i = next++; i < jobs.size(); i = next++) {
      try {
        SharedProgress::OfOneRun of_this_run(shared);
        runJob(jobs[i], plan, method, manifest, of_this_run, observer);
        of_this_run.finish();
      } catch (...) {
        errors[i] = std::current_exception();
        next = jobs.size();
      }
    }
  };
  std::vector<std::thread> threads;
  for (int t = 1; t < thread_count; ++t) threads.emplace_back(work);
  work();
  for (auto& thread : threads) thread.join();
  for (const auto& error : errors)
    if (error) std::rethrow_exception(error);
}

/// A figure of the tables: how it is taken from a run, and how it is shown.
struct Figure {
  report::Column column;
  double (*of)(const Exploration&);
  bool for_people;         ///< in the printed table too
  bool never_is_endless;   ///< NaN means "never reached": counts as infinitely late in a median
  bool of_oracle = false;  ///< in the printed table when the oracle was asked
};

const std::vector<Figure>& figures() {
  using E = const Exploration&;
  static const std::vector<Figure> all = {
      {{"coverage_percent", "explored %", 1}, [](E e) { return 100 * e.figures.coverage; }, true, false},
      {{"t90_s", "90 % s", 0}, [](E e) { return e.figures.t90_s; }, true, true},
      {{"t99_s", "99 % s", 0}, [](E e) { return e.figures.t99_s; }, true, true},
      {{"time_s", "end s", 0}, [](E e) { return e.figures.time_s; }, true, false},
      {{"path90_m", "90 % m", 1}, [](E e) { return e.figures.path90_m; }, true, true},
      {{"path99_m", "99 % m", 1}, [](E e) { return e.figures.path99_m; }, true, true},
      {{"ratio90", "90 % ratio", 2}, [](E e) { return e.ratio90; }, false, true, true},
      {{"ratio99", "99 % ratio", 2}, [](E e) { return e.ratio99; }, false, true, true},
      {{"path_m", "path m", 1}, [](E e) { return e.figures.path_m; }, true, false},
      {{"redundant_percent", "redundant %", 0},
       [](E e) { return 100 * e.figures.redundant_share; },
       true,
       false},
      {{"collisions", "collisions", 0}, [](E e) { return e.collisions; }, true, false},
      {{"near_misses", "near", 0}, [](E e) { return e.near_misses; }, true, false},
      {{"decisions", "decisions", 0}, [](E e) { return e.decisions; }, true, false},
      {{"ate_rmse_m", "ATE m", 3}, [](E e) { return e.evaluation.trajectory.position_m.rmse; }, true, false},
      {{"wall_f1", "wall F1", 3}, [](E e) { return e.evaluation.map.occupied_f1; }, true, false},
      {{"free_iou", "free IoU", 3}, [](E e) { return e.evaluation.map.free_iou; }, false, false},
      {{"scans", "scans", 0}, [](E e) { return static_cast<double>(e.figures.scans); }, false, false},
      {{"scans90", "scans 90 %", 0}, [](E e) { return e.figures.scans90; }, false, true},
      {{"scans99", "scans 99 %", 0}, [](E e) { return e.figures.scans99; }, false, true},
      {{"return_distance_m", "to start m", 2}, [](E e) { return e.return_distance_m; }, false, false},
      {{"oracle90_m", "oracle 90 % m", 1}, [](E e) { return e.oracle90_m; }, false, false},
      {{"oracle99_m", "oracle 99 % m", 1}, [](E e) { return e.oracle99_m; }, false, false},
      {{"below90_m", "least 90 % m", 1}, [](E e) { return e.below90_m; }, false, false},
      {{"below99_m", "least 99 % m", 1}, [](E e) { return e.below99_m; }, false, false},
      {{"explorable_m2", "explorable m2", 1}, [](E e) { return e.explorable_m2; }, false, false},
      {{"explorable_share", "of free", 3}, [](E e) { return e.explorable_share; }, false, false}};
  return all;
}

/// Which end of a figure is good, for those where one is.
std::map<std::string, report::Best> bestFigures() {
  std::map<std::string, report::Best> best;
  for (const char* key : {"t90_s", "t99_s", "path90_m", "path99_m", "ratio90", "ratio99", "redundant_percent",
                          "collisions", "near_misses", "ate_rmse_m"})
    best[key] = report::Best::kSmallest;
  for (const char* key : {"coverage_percent", "wall_f1"}) best[key] = report::Best::kLargest;
  return best;
}

using Runs = std::vector<const Exploration*>;

/// Quantile over the runs that have not failed; NaN when it falls on a run that never got there.
double quantileOf(const Figure& figure, const Runs& runs, double share) {
  std::vector<double> values;
  for (const Exploration* e : runs) {
    if (e->end == ExplorationEnd::kFailed) continue;
    const double value = figure.of(*e);
    if (std::isnan(value) && !figure.never_is_endless) return kNaN;
    values.push_back(std::isnan(value) ? kInfinity : value);
  }
  const double result = metrics::quantile(values, share);
  return std::isfinite(result) ? result : kNaN;
}

std::string slamLabel(const std::string& slam) {
  return slam == kTruthReference ? "truth (reference)" : slam;
}

/// "finished 8, duration 2"
std::string endsOf(const Runs& runs) {
  std::map<ExplorationEnd, int> counts;
  for (const Exploration* e : runs) ++counts[e->end];
  std::string text;
  for (const auto& [end, count] : counts)
    text += (text.empty() ? "" : ", ") + endName(end) + (runs.size() == 1 ? "" : " " + std::to_string(count));
  return text;
}

double countOf(const Runs& runs, double metrics::ExplorationFigures::*reached) {
  return static_cast<double>(std::count_if(
      runs.begin(), runs.end(), [&](const Exploration* e) { return std::isfinite(e->figures.*reached); }));
}

report::Table runsTable(const std::vector<Exploration>& runs, const std::string& plan_name) {
  report::Table table;
  table.columns = {{"plan", "plan"}, {"strategy", "strategy"}, {"slam", "slam"}, {"seed", "seed", 0}};
  for (const auto& figure : figures()) table.columns.push_back(figure.column);
  table.columns.push_back({"end", "end"});
  table.columns.push_back({"end_detail", "end detail"});
  for (const auto& e : runs) {
    std::vector<report::CellValue> row = {plan_name, e.strategy, slamLabel(e.slam),
                                          static_cast<double>(e.seed)};
    for (const auto& figure : figures()) row.emplace_back(figure.of(e));
    row.emplace_back(endName(e.end));
    row.emplace_back(e.end_detail);
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// Runs of one strategy each, in the order of the request.
std::vector<Runs> byStrategy(const std::vector<Exploration>& runs, int seeds) {
  std::vector<Runs> groups;
  for (size_t i = 0; i < runs.size(); ++i) {
    if (i % static_cast<size_t>(seeds) == 0) groups.emplace_back();
    groups.back().push_back(&runs[i]);
  }
  return groups;
}

/// For programs: median and quartiles as columns of their own.
report::Table statisticsTable(const std::vector<Runs>& groups, const std::string& plan_name) {
  report::Table table;
  table.columns = {{"plan", "plan"},
                   {"strategy", "strategy"},
                   {"slam", "slam"},
                   {"runs", "runs", 0},
                   {"failed", "failed", 0},
                   {"reached90", "reached 90 %", 0},
                   {"reached99", "reached 99 %", 0}};
  for (const auto& figure : figures())
    for (const char* suffix : {"", "_q1", "_q3"})
      table.columns.push_back({figure.column.key + suffix, figure.column.key + suffix});
  table.columns.push_back({"ends", "ends"});
  for (const auto& runs : groups) {
    const auto failed = std::count_if(runs.begin(), runs.end(),
                                      [](const Exploration* e) { return e->end == ExplorationEnd::kFailed; });
    std::vector<report::CellValue> row = {plan_name,
                                          runs.front()->strategy,
                                          slamLabel(runs.front()->slam),
                                          static_cast<double>(runs.size()),
                                          static_cast<double>(failed),
                                          countOf(runs, &metrics::ExplorationFigures::t90_s),
                                          countOf(runs, &metrics::ExplorationFigures::t99_s)};
    for (const auto& figure : figures())
      for (const double share : {0.5, 0.25, 0.75}) row.emplace_back(quantileOf(figure, runs, share));
    row.emplace_back(endsOf(runs));
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string fixed(double value, int decimals) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return std::isnan(value) ? "-" : text;
}

/// For people: a row per strategy, with several seeds a second one with the quartiles.
report::Table scoresTable(const std::vector<Runs>& groups, const std::string& caption, bool with_oracle) {
  const auto isShown = [&](const Figure& figure) {
    return figure.for_people || (figure.of_oracle && with_oracle);
  };
  report::Table table;
  table.caption = caption;
  table.columns = {{"strategy", "strategy"}};
  for (const auto& figure : figures())
    if (isShown(figure)) table.columns.push_back(figure.column);
  table.columns.push_back({"end", "end"});
  for (const auto& runs : groups) {
    std::vector<report::CellValue> row = {runs.front()->strategy}, spread = {std::string("  25 to 75 %")};
    for (const auto& figure : figures()) {
      if (!isShown(figure)) continue;
      const int decimals = figure.column.decimals;
      row.emplace_back(quantileOf(figure, runs, 0.5));
      spread.emplace_back(fixed(quantileOf(figure, runs, 0.25), decimals) + ".." +
                          fixed(quantileOf(figure, runs, 0.75), decimals));
    }
    row.emplace_back(endsOf(runs));
    spread.emplace_back(std::string());
    table.rows.push_back(std::move(row));
    if (runs.size() > 1) table.rows.push_back(std::move(spread));
  }
  return table;
}

void addNotes(const std::vector<Job>& jobs, const ExploreRequest& request, const LoopMethod& method,
              report::Table& table) {
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
    const auto& e = job.result.exploration;
    std::vector<std::string> about;
    if (e.explorable_share < kCutOffBelow)
      about.push_back("From the start only " + fixed(100 * e.explorable_share, 0) +
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
    for (const auto& note : about)
      if (said.insert(note).second) notes.push_back(note);
  }
}

report::Table costTable(const std::vector<Exploration>& runs) {
  report::Table table;
  table.caption = "CPU time per decision on this machine";
  table.columns = {{"strategy", "strategy"},
                   {"seed", "seed", 0},
                   {"decision_mean_ms", "mean ms", 3},
                   {"decision_max_ms", "max ms", 3}};
  for (const auto& e : runs)
    table.rows.push_back({e.strategy, static_cast<double>(e.seed), e.decision_mean_ms, e.decision_max_ms});
  return table;
}

/// A chart needs no more points than it has pixels: those at which something changes, and the last.
std::vector<core::Point2> thinned(const std::vector<metrics::CoveragePoint>& curve, double explorable_m2,
                                  double (*x)(const metrics::CoveragePoint&)) {
  std::vector<core::Point2> points;
  for (size_t i = 0; i < curve.size(); ++i) {
    const core::Point2 p{x(curve[i]), 100 * curve[i].explored_m2 / explorable_m2};
    const bool repeats = points.size() > 1 && points.back().y == p.y && points[points.size() - 2].y == p.y;
    if (repeats) points.pop_back();
    points.push_back(p);
  }
  return points;
}

void drawCoverage(const std::vector<Job>& jobs, const oracle::Oracle* oracle, const std::string& title,
                  const std::string& png_path) {
  using P = const metrics::CoveragePoint&;
  const std::pair<const char*, double (*)(P)> axes[] = {
      {"time (s)", [](P p) { return p.time_s; }},
      {"path (m)", [](P p) { return p.path_m; }},
      {"scans", [](P p) { return static_cast<double>(p.scans); }}};
  std::vector<report::Chart> charts;
  for (const auto& [x_title, x] : axes) {
    report::Chart chart{x_title, "explored (% of the explorable area)", {}, 100};
    for (const auto& job : jobs)
      chart.curves.push_back({job.result.exploration.strategy,
                              thinned(job.result.curve, job.result.exploration.explorable_m2, x)});
    charts.push_back(std::move(chart));
  }
  if (oracle) charts[1].curves.push_back(oracleCurve(*oracle));
  report::drawCharts(charts, title, png_path);
}

/// The curves of runs that leave no folder of their own.
std::string curvesCsv(const std::vector<Job>& jobs) {
  report::Table table;
  table.columns = {{"strategy", "strategy", 0},
                   {"seed", "seed", 0},
                   {"time_s", "time s", 3},
                   {"path_m", "path m", 4},
                   {"explored_share", "explored", 6}};
  for (const auto& job : jobs)
    for (const auto& p : job.result.curve)
      table.rows.push_back({job.result.exploration.strategy, static_cast<double>(job.seed), p.time_s,
                            p.path_m, p.explored_m2 / job.result.exploration.explorable_m2});
  return report::toCsv(table);
}

std::vector<Job> makeJobs(const ExploreRequest& request, const std::string& folder) {
  std::vector<Job> jobs;
  const bool single = request.strategies.size() == 1 && request.seeds == 1;
  for (const auto& config : request.strategies)
    for (int k = 0; k < request.seeds; ++k) {
      Job job;
      job.config = &config;
      job.seed = request.seed + static_cast<std::uint64_t>(k);
      if (!request.tables_only) {
        job.folder = single ? folder : folder + "/" + strategyNameOf(config);
        if (request.seeds > 1) job.folder += "/seed_" + std::to_string(job.seed);
      }
      jobs.push_back(std::move(job));
    }
  return jobs;
}

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

}  // namespace

const std::string& strategyNameOf(const ExploreConfig& config) {
  return config.own ? config.own->name : config.record.strategy.name;
}

const core::ParameterTable<ExplorationOptions>& ExplorationOptions::table() {
  using O = ExplorationOptions;
  static const core::ParameterTable<O> rows(
      "exploration",
      {{"stuck_s", &O::stuck_s, 60.0, 0.0, 1e7,
        "end after so long without new area and without a new place 1 m away; 0 = never"},
       {"give_up_s", &O::give_up_s, 300.0, 0.0, 1e7,
        "end after so long without 0.1 m2 of new area; 0 = never"},
       {"return_to_start", &O::return_to_start, false, "after finishing drive back to the start"}});
  return rows;
}

ExplorationOptions::ExplorationOptions() {
  table().setDefaults(*this);
}

ExploreConfig readExploreConfig(const core::IniFile& ini) {
  ExploreConfig config;
  config.record = record::readRecordConfig(ini, {ExplorationOptions::table().section()});
  core::readParameters(ini, ExplorationOptions::table(), config.exploration, &config.record.parameters);
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
  e.collisions = e.near_misses = e.decisions = kNaN;
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

const std::vector<std::pair<std::string, std::string>>& explorationFigureInfos() {
  static const std::vector<std::pair<std::string, std::string>> infos = {
      {"coverage_percent",
       "explored share of what can be explored: the free cells that the robot's disc can reach, or see from "
       "there"},
      {"t90_s", "robot's time until 90 % of that were explored; t99_s likewise"},
      {"path90_m", "true path until then; path99_m, scans90 and scans99 likewise"},
      {"ratio99",
       "with --oracle: path99_m over what a tour of somebody who knows the plan needs (oracle99_m); "
       "below99_m is "
       "what no path can be shorter than; ratio90 and the like likewise"},
      {"redundant_percent",
       "share of the path that adds no new area: pieces of 1 m that show less than 0.1 m2"},
      {"collisions", "commands that a wall cut short"},
      {"near_misses", "episodes with less than 0.05 m between the robot's disc and a wall"},
      {"return_distance_m", "true distance to the start after driving back to it"}};
  return infos;
}

namespace {

/// Which oracle a run is scored by: one for all, or where furniture has moved each seed's own.
std::uint64_t oracleOf(const ExploreRequest& request, const Job& job) {
  return job.config->record.living.visit > 1 ? job.seed : request.seed;
}

std::map<std::uint64_t, oracle::Oracle> askForAll(const ExploreRequest& request, const world::Plan& plan,
                                                  const std::vector<Job>& jobs, core::Progress& progress) {
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

}  // namespace

ExplorationReport explore(const ExploreRequest& request, core::Manifest manifest, core::Progress& progress) {
  checkRequest(request);
  const auto method = loadMethod(request);
  const auto plan = world::loadPlan(request.plan_path);
  core::PendingFolder output(request.output, request.overwrite);
  manifest.seed = request.seed;
  manifest.inputs[request.plan_path] = core::fileSha256(request.plan_path);

  auto jobs = makeJobs(request, output.path());
  const auto oracles = askForAll(request, plan, jobs, progress);
  progress.begin("exploring " + plan.name);
  runJobs(jobs, plan, method, request.threads, manifest, progress, request.observer);
  progress.end();
  for (auto& job : jobs)
    if (request.oracle) compareWith(oracles.at(oracleOf(request, job)), job.result.exploration);

  ExplorationReport result;
  int kept = 0;
  for (const auto& job : jobs) {
    result.runs.push_back(job.result.exploration);
    if (job.result.exploration.end != ExplorationEnd::kFailed) continue;
    ++result.failed;
    kept += job.folder.empty() || !fs::exists(job.folder + "/manifest.json") ? 0 : 1;
    if (!job.folder.empty() && job.folder != output.path() && fs::is_empty(job.folder))
      fs::remove(job.folder);
  }
  if (result.failed == static_cast<int>(jobs.size()) && kept == 0)
    throw core::MethodError(result.runs.front().end_detail);

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
  const std::string folder = output.path();
  core::writeFileAtomically(folder + "/scores.txt", report::toText(result.scores));
  core::writeFileAtomically(folder + "/scores.md", report::toMarkdown(result.scores));
  core::writeFileAtomically(folder + "/scores.tex",
                            report::toLatex(result.scores, {"tab:scores", bestFigures()}));
  core::writeFileAtomically(folder + "/scores.csv", report::toCsv(statistics));
  core::writeFileAtomically(folder + "/scores.json", report::toJson(statistics));
  core::writeFileAtomically(folder + "/runs.csv", report::toCsv(runsTable(result.runs, plan.name)));
  core::writeFileAtomically(folder + "/cost.csv", report::toCsv(result.cost));
  core::writeFileAtomically(folder + "/cost.json", report::toJson(result.cost));
  if (first) {
    const auto& living = request.strategies.front().record.living;
    writeOracle(*first, record::planOfVisit(plan, living, request.seed), folder);
  }
  drawCoverage(jobs, first, caption, folder + "/coverage.png");
  if (request.tables_only) core::writeFileAtomically(folder + "/curves.csv", curvesCsv(jobs));

  // A single run has already left a manifest there: the same one, with more in it.
  if (fs::exists(folder + "/manifest.json")) manifest = core::readManifest(folder + "/manifest.json");
  manifest.files["scores.txt"] = "the table; also .md and .tex, and .csv and .json with quartiles";
  manifest.files["runs.csv"] = "every figure of every run";
  if (request.tables_only)
    manifest.files["curves.csv"] = "explored share over time and path: rasterslam plot exploration";
  manifest.files["coverage.png"] = "explored share over time, path and scans";
  if (first)
    manifest.files["oracle.csv"] = "tours with the plan in hand: path and share; also _path.csv, .png";
  manifest.files["cost.csv"] = "CPU time of the decisions; also .json";
  manifest.results.emplace("status", "complete");  // a single run that failed has said so
  manifest.results["failed_runs"] = std::to_string(result.failed);
  core::writeManifest(manifest, folder + "/manifest.json");
  output.commit();
  return result;
}

}  // namespace slam::explore
