#include "libslam/score/compare.h"

#include <algorithm>
#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/logs/log_reader.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/resources/file_hash.h"
#include "libslam/run/build_map.h"
#include "libslam/run/log_feed.h"
#include "libslam/run/told_commands.h"
#include "libslam/score/compare_pictures.h"
#include "libslam/score/compared_methods.h"
#include "libslam/score/metric_infos.h"
#include "libslam/score/relation_tables.h"
#include "libslam/table/latex.h"
#include "libslam/truth/truth_files.h"

namespace slam::score {
namespace fs = std::filesystem;
namespace {

/// Which end of a metric is good, for those where one is.
std::map<std::string, table::Best> bestMetrics() {
  std::map<std::string, table::Best> best;
  for (const auto& info : metricInfos())
    if (info.better)
      best[info.key] =
          *info.better == stats::Better::kSmaller ? table::Best::kSmallest : table::Best::kLargest;
  return best;
}

/// An output folder is new, or ours to replace, or ours to go on with.
files::OutputLock prepareOutput(const CompareRequest& request) {
  const std::string manifest = request.output + "/manifest.json";
  std::error_code error;
  if (fs::exists(request.output) && !fs::is_directory(request.output))
    throw core::InputError(request.output + ": is a file, expected a folder");
  const bool empty = !fs::exists(request.output) || fs::is_empty(request.output);
  if (!empty && !fs::exists(manifest))
    throw core::InputError(
        request.output + ": holds other files and no manifest.json, so it is not replaced; remove it first");
  if (!empty && !request.overwrite && !request.resume)
    throw core::InputError(request.output + ": exists; give --overwrite to replace it or --resume to go on");
  fs::create_directories(fs::absolute(request.output).parent_path(), error);
  if (error) throw core::IoError(request.output + ": cannot be made: " + error.message());
  files::OutputLock lock(request.output);
  if (!empty && request.overwrite) fs::remove_all(request.output, error);
  fs::create_directories(request.output, error);
  if (error) throw core::IoError(request.output + ": cannot be made: " + error.message());
  return lock;
}

/// The relations that were asked for. That they belong to another log must not show after an hour.
core::Relations loadRelations(const CompareRequest& request, const logs::LogInfo& log) {
  if (request.relations_path.empty()) return {};
  auto relations = logs::readRelations(request.relations_path);
  const auto isWithin = [&](double time_s) {
    return time_s >= log.first_time_s && time_s <= log.last_time_s;
  };
  if (std::none_of(relations.begin(), relations.end(), [&](const core::Relation& relation) {
        return isWithin(relation.from_time_s) && isWithin(relation.to_time_s);
      }))
    throw core::InputError(request.relations_path + ": no relation lies within the time of " +
                           request.log_path + ", expected the relations of the same log");
  return relations;
}

void scoreByRelations(const std::vector<results::RunFolder>& runs, const core::Relations& relations,
                      const std::string& output, Comparison& comparison) {
  std::vector<RelationScore> scores;
  for (const auto& run : runs)
    for (auto& score : score::scoreByRelations(run, relations)) scores.push_back(std::move(score));
  comparison.relations = relationTable(scores, Detail::kShort);
  comparison.worst_relations = worstRelationsTable(relations, scores, Detail::kShort);
  const auto full = relationTable(scores, Detail::kFull);
  const auto worst = worstRelationsTable(relations, scores, Detail::kFull);
  files::writeFileAtomically(output + "/relations.txt", table::toText(*comparison.relations) + "\n" +
                                                            table::toText(*comparison.worst_relations));
  files::writeFileAtomically(output + "/relations.csv", table::toCsv(full));
  files::writeFileAtomically(output + "/relations.json", table::toJson(full));
  files::writeFileAtomically(output + "/worst_relations.csv", table::toCsv(worst));
}

/// Under the tables: which methods took the kinds of the commands from the wheels, and which took skewed
/// scans.
void noteCommands(const std::vector<results::RunFolder>& runs, const std::vector<table::Table*>& tables) {
  for (const auto& run : runs) {
    const auto from = run.manifest.results.find("commands_from");
    const std::string note =
        from == run.manifest.results.end() ? "" : run::commandsNote(run.method, from->second);
    for (const auto& text : {note, run::skewNote(run.method, run.manifest.results)})
      if (!text.empty())
        for (auto* table : tables) table->notes.push_back(text + ".");
  }
}

/// The log that is compared on: simulated, or the given one. The manifest gets the inputs.
std::string logOf(const CompareRequest& request, const std::optional<world::Plan>& plan,
                  resources::Manifest& manifest, core::Progress& progress) {
  if (!plan) {
    manifest.inputs[request.log_path] = resources::fileSha256(request.log_path);
    return request.log_path;
  }
  std::string log_path = request.output + "/log/run.rawlog";
  fs::create_directories(request.output + "/log");
  manifest.inputs[request.plan_path] = resources::fileSha256(request.plan_path);
  record::record(*plan, request.record, request.seed, log_path, manifest, progress);
  return log_path;
}

/// The plan that the truth is of, as far as the request says so.
std::string truthPlanOf(const CompareRequest& request) {
  if (!request.truth_plan_path.empty()) return request.truth_plan_path;
  // A recording on a later visit has a true plan of its own.
  return request.record.living.visit > 1 ? "" : request.plan_path;
}

void runAll(std::vector<ComparedMethod>& methods, const CompareRequest& request, resources::Manifest manifest,
            Comparison& comparison, core::Progress& progress) {
  manifest.inputs.clear();
  manifest.results.clear();
  for (auto& method : methods) {
    progress.update(-1, 0);
    method.reused = request.resume && isSameRun(method, comparison.log_path, request.seed);
    comparison.reused += method.reused ? 1 : 0;
  }
  runMethods(methods, comparison.log_path, request, manifest, progress);
}

std::vector<results::RunFolder> loadRuns(const std::vector<ComparedMethod>& methods,
                                         core::Progress& progress) {
  std::vector<results::RunFolder> runs;
  for (const auto& method : methods) {
    progress.update(-1, 0);
    if (method.failure.empty()) runs.push_back(results::loadRun(method.folder));
  }
  return runs;
}

void evaluateAll(const std::vector<ComparedMethod>& methods, const std::vector<results::RunFolder>& runs,
                 const std::optional<Truth>& truth, Comparison& comparison, core::Progress& progress) {
  for (const auto& method : methods) {
    progress.update(-1, 0);
    const auto run = std::find_if(runs.begin(), runs.end(),
                                  [&](const results::RunFolder& r) { return r.path == method.folder; });
    comparison.evaluations.push_back(run == runs.end() ? failedEvaluation(method.name, method.failure)
                                                       : evaluate(*run, truth));
    comparison.failed += comparison.evaluations.back().failure.empty() ? 0 : 1;
  }
  setAgreement(runs, comparison.evaluations);
}

void makeTables(const std::vector<results::RunFolder>& runs, const std::optional<Truth>& truth,
                Comparison& comparison) {
  const auto& evaluations = comparison.evaluations;
  comparison.accuracy = truth ? accuracyTable(evaluations, *truth, Detail::kShort)
                              : agreementTable(evaluations, Detail::kShort);
  comparison.full_accuracy =
      truth ? accuracyTable(evaluations, *truth, Detail::kFull) : agreementTable(evaluations, Detail::kFull);
  if (!runs.empty()) {
    const std::string steps = runs.front().manifest.results.at("steps_without_odometry");
    if (steps != "0")
      for (auto* table : {&comparison.accuracy, &comparison.full_accuracy})
        table->notes.push_back(steps + " steps of the log come without odometry; methods that want the " +
                               "wheels get increments estimated from the scans there.");
  }
  noteCommands(runs, {&comparison.accuracy, &comparison.full_accuracy});
  comparison.cost = costTable(evaluations);
}

void writeTables(const Comparison& comparison, const std::string& output) {
  const auto write = [&](const char* name, const std::string& text) {
    files::writeFileAtomically(output + "/" + name, text);
  };
  write("scores.txt", table::toText(comparison.accuracy));
  write("scores.md", table::toMarkdown(comparison.accuracy));
  write("scores.tex", table::toLatex(comparison.accuracy, {"tab:scores", bestMetrics()}));
  write("scores.csv", table::toCsv(comparison.full_accuracy));
  write("scores.json", table::toJson(comparison.full_accuracy));
  write("cost.csv", table::toCsv(comparison.cost));
  write("cost.json", table::toJson(comparison.cost));
}

void describeFiles(const Comparison& comparison, resources::Manifest& manifest) {
  manifest.files["scores.txt"] = "accuracy of every method; also .md, .tex, .csv, .json";
  if (comparison.relations)
    manifest.files["relations.csv"] =
        "error of every path against the relations; also .txt, .json; the worst in worst_relations.csv";
  manifest.files["cost.csv"] = "time and memory of every method; also .json";
  manifest.files["maps.png"] = "the map of every method, side by side";
  manifest.files["paths.png"] = "all paths on one plan";
  manifest.files["scan.png"] = "the first scan: range over angle, and polar";
  manifest.results["status"] = "complete";
  manifest.results["failed_methods"] = std::to_string(comparison.failed);
}

}  // namespace

Comparison compare(const CompareRequest& request, resources::Manifest manifest, core::Progress& progress) {
  auto methods = loadMethods(request);
  std::optional<world::Plan> plan;
  if (!request.plan_path.empty()) plan = world::loadPlan(request.plan_path);
  core::Relations relations;
  if (!request.log_path.empty()) {
    const auto log = logs::inspectLog(request.log_path);
    logs::requireUsable(log);
    relations = loadRelations(request, log);
  }
  const auto lock = prepareOutput(request);
  manifest.seed = request.seed;
  manifest.results["status"] = "incomplete";
  resources::writeManifest(manifest, request.output + "/manifest.json");

  Comparison comparison;
  comparison.log_path = logOf(request, plan, manifest, progress);
  runAll(methods, request, manifest, comparison, progress);
  const auto runs = loadRuns(methods, progress);
  const std::string plan_path = truthPlanOf(request);
  const auto truth_files = truth::truthFiles(comparison.log_path, request.truth_path, plan_path);
  std::optional<Truth> truth;
  if (!truth_files.trajectory.empty() && !runs.empty())
    truth = loadTruth(truth_files.trajectory, truth_files.plan, runs.front());
  comparison.has_truth = truth.has_value();
  evaluateAll(methods, runs, truth, comparison, progress);
  makeTables(runs, truth, comparison);
  if (!relations.empty() && !runs.empty()) {
    manifest.inputs[request.relations_path] = resources::fileSha256(request.relations_path);
    scoreByRelations(runs, relations, request.output, comparison);
    if (!truth)
      for (auto* table : {&comparison.accuracy, &comparison.full_accuracy})
        table->caption = "Beside the relations: what can be said without a truth";
  }
  writeTables(comparison, request.output);
  drawPictures(runs, comparison.evaluations, truth, comparison.log_path, request.output, progress);

  describeFiles(comparison, manifest);
  if (truth && !request.truth_path.empty()) manifest.results["truth"] = request.truth_path;
  if (truth && !plan_path.empty()) manifest.results["plan"] = plan_path;
  resources::writeManifest(manifest, request.output + "/manifest.json");
  return comparison;
}

}  // namespace slam::score
