#include "libslam/score/compare.h"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "libslam/core/error.h"
#include "libslam/core/files.h"
#include "libslam/core/ini_yaml.h"
#include "libslam/logs/convert.h"
#include "libslam/logs/log_reader.h"
#include "libslam/logs/relations_io.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/mapping/method_config.h"
#include "libslam/process/worker.h"
#include "libslam/record/truth_files.h"
#include "libslam/report/picture.h"
#include "libslam/report/table_latex.h"
#include "libslam/run/build_map.h"
#include "libslam/run/external_method.h"
#include "libslam/run/log_feed.h"
#include "libslam/run/scene_file.h"
#include "libslam/run/told_commands.h"
#include "libslam/score/relation_tables.h"

namespace slam::score {
namespace fs = std::filesystem;
namespace {

struct Method {
  std::string name, argument, folder;  // argument: as the request names it
  core::IniFile config;
  std::vector<std::string> settings;  // of the request, for this method
  std::string failure;
  bool reused = false;
};

/// The request's settings that the method has a section for.
std::vector<std::string> settingsOf(const core::IniFile& config, const CompareRequest& request) {
  const auto* type = config.find("method", "type");
  const auto sections = mapping::methodSections(type == nullptr ? "" : type->value);
  std::vector<std::string> own;
  for (const auto& setting : request.method_settings)
    if (std::count(sections.begin(), sections.end(), setting.substr(0, setting.find('.'))) > 0)
      own.push_back(setting);
  return own;
}

void requireUsed(const CompareRequest& request, const std::vector<Method>& methods) {
  for (const auto& setting : request.method_settings)
    if (std::none_of(methods.begin(), methods.end(), [&](const Method& method) {
          return std::count(method.settings.begin(), method.settings.end(), setting) > 0;
        }))
      throw core::InputError("--set: found '" + setting +
                             "', expected a section of a method that is compared");
}

std::vector<Method> loadMethods(const CompareRequest& request) {
  std::vector<Method> methods;
  for (const auto& name_or_path : request.methods) {
    Method method;
    method.name = core::isConfigFile(name_or_path) ? fs::path(name_or_path).stem().string() : name_or_path;
    method.argument = name_or_path;
    method.config = mapping::loadMethodConfig(request.methods_folder, name_or_path);
    method.settings = settingsOf(method.config, request);
    for (const auto& setting : method.settings) method.config.setFromArgument(setting, "--set");
    method.folder = request.output + "/" + method.name;
    for (const auto& other : methods)
      if (other.name == method.name) throw core::InputError("method '" + method.name + "' is named twice");
    run::methodParameters(method.config);  // a bad key must not show after an hour
    methods.push_back(std::move(method));
  }
  if (methods.empty()) throw core::InputError("no method named, expected at least one");
  requireUsed(request, methods);
  return methods;
}

/// Which end of a metric is good, for those where one is.
std::map<std::string, report::Best> bestMetrics() {
  std::map<std::string, report::Best> best;
  for (const auto& info : metricInfos())
    if (info.better)
      best[info.key] =
          *info.better == stats::Better::kSmaller ? report::Best::kSmallest : report::Best::kLargest;
  return best;
}

/// True when the folder holds a finished run of the same method on the same log with the same seed and
/// program.
bool isSameRun(const Method& method, const std::string& log_path, std::uint64_t seed) {
  if (!fs::exists(method.folder + "/manifest.json")) return false;
  try {
    const auto manifest = core::readManifest(method.folder + "/manifest.json");
    if (manifest.results.count("status") > 0) return false;  // it ended before its log did
    for (const auto& line : run::methodParameters(method.config)) {
      const auto it = manifest.config.find(line.section + "." + line.info.key);
      if (it == manifest.config.end() || it->second != line.value) return false;
    }
    if (run::isExternal(method.config))
      for (const auto& [path, hash] : run::programFiles(method.config))
        if (const auto it = manifest.inputs.find(path); it == manifest.inputs.end() || it->second != hash)
          return false;
    const auto input = manifest.inputs.find(log_path);
    return manifest.seed == seed && manifest.version == core::versionText() &&
           input != manifest.inputs.end() && input->second == core::fileSha256(log_path);
  } catch (const core::InputError&) {
    return false;
  }
}

/// The note of a method that failed on the way: what it had mapped is there to look at, and no row of figures, for they
/// would stand beside those of the whole log.
std::string keptText(const std::string& where_and_why) {
  return where_and_why + "; what it had mapped is kept";
}

/// Runs one method in a process of its own. Throws MethodError for whatever goes wrong with the method alone.
void runInProcess(const Method& method, const std::string& log_path, const CompareRequest& request,
                  core::Progress& progress) {
  std::vector<std::string> command = {
      request.program, "run",         method.argument, log_path, "-o",
      method.folder,   "--overwrite", "--json",        "--seed", std::to_string(request.seed)};
  if (request.quiet) command.emplace_back("--quiet");
  for (const auto& setting : method.settings) command.insert(command.end(), {"--set", setting});
  const auto result = process::runWorker(command, progress);
  if (result.exit_code == 0) return;
  if (result.exit_code == static_cast<int>(core::ExitCode::kInterrupted)) throw core::Interrupted();
  std::string why = result.killed ? "killed by signal " + std::to_string(result.exit_code - 128)
                                  : "exit code " + std::to_string(result.exit_code);
  const auto json = nlohmann::json::parse(result.out, nullptr, false);
  if (json.is_object() && json.contains("failed")) throw core::MethodError(keptText(json["failed"]));
  // Lost at the end: all is written, and the row says so.
  if (json.is_object() && json.contains("lost")) return;
  if (json.is_object() && json.contains("error")) why = json["error"].get<std::string>();
  if (result.exit_code == static_cast<int>(core::ExitCode::kBadInput)) throw core::InputError(why);
  // A full disk is not the method's fault.
  if (json.is_object() && json.contains("machine")) throw core::IoError(why);
  throw core::MethodError(why);
}

/// Runs methods side by side; each is independent, so the number of threads changes nothing but the time.
void runMethods(std::vector<Method>& methods, const std::string& log_path, const CompareRequest& request,
                const core::Manifest& manifest, core::Progress& progress) {
  std::atomic<size_t> next{0};
  std::vector<std::exception_ptr> errors(methods.size());
  const auto work = [&] {
    for (size_t i = next++; i < methods.size(); i = next++) {
      Method& method = methods[i];
      if (method.reused) continue;
      try {
        if (!request.program.empty()) {
          runInProcess(method, log_path, request, progress);
        } else {
          const auto run = run::buildMap(log_path, method.config, method.name, request.seed, method.folder,
                                         true, manifest, progress, false);
          if (run.stopped) throw core::MethodError(keptText(run::stopText(*run.stopped)));
        }
      } catch (const core::MethodError& error) {
        method.failure = error.what();
      } catch (...) {
        errors[i] = std::current_exception();
        next = methods.size();
      }
    }
  };
  std::vector<std::thread> threads;
  for (int t = 1; t < request.threads; ++t) threads.emplace_back(work);
  work();
  for (auto& thread : threads) thread.join();
  for (const auto& error : errors)
    if (error) std::rethrow_exception(error);
}

core::Trajectory moved(const core::Pose2& T_world_map, core::Trajectory trajectory) {
  for (auto& stamped : trajectory) stamped.pose = T_world_map * stamped.pose;
  return trajectory;
}

std::string subtitle(const Evaluation& e, bool has_truth) {
  char text[64];
  if (has_truth)
    std::snprintf(text, sizeof text, "final ATE %.3f m", e.final_trajectory.position_m.rmse);
  else
    std::snprintf(text, sizeof text, "path %.1f m", e.path_length_m);
  return text;
}

/// Several paths side by side, for on one plan they would hide one another.
void drawPaths(const std::vector<report::Panel>& maps, const world::Plan& ground,
               const std::vector<report::DrawnPath>& paths, const std::string& file) {
  constexpr std::size_t kMostPanels = 8;
  if (maps.size() < 2 || maps.size() > kMostPanels) return report::drawPlan(ground, paths, ground.name, file);
  auto panels = report::pathPanels(ground, paths);
  for (std::size_t i = 0; i < panels.size(); ++i) panels[i].subtitle = maps[i].subtitle;
  report::drawPanels(panels, file);
}

void drawPictures(const std::vector<run::RunFolder>& runs, const std::vector<Evaluation>& evaluations,
                  const std::optional<Truth>& truth, const std::string& log_path, const std::string& output,
                  core::Progress& progress) {
  std::vector<report::Panel> panels;
  std::vector<report::DrawnPath> paths;
  if (truth) paths.push_back({truth->trajectory, "truth", true});
  for (const auto& run : runs) {
    progress.update(-1, 0);
    const auto& e = *std::find_if(evaluations.begin(), evaluations.end(),
                                  [&](const Evaluation& x) { return x.method == run.method; });
    const core::Pose2 T_world_map = truth ? e.final_trajectory.T_truth_estimate : core::Pose2{};
    report::Panel panel{run.method, subtitle(e, truth.has_value()), run.map, T_world_map, {}};
    if (truth) panel.paths.push_back({truth->trajectory, "truth", true});
    panel.paths.push_back({moved(T_world_map, run.final_estimate.value_or(run.estimate)), run.method, false});
    paths.push_back(panel.paths.back());
    panels.push_back(std::move(panel));
    if (truth && core::isFinite(T_world_map) && fs::exists(run.path + "/map.3Dscene"))
      run::addTruthToScene(truth->trajectory, truth->plan ? &*truth->plan : nullptr,
                           core::inverse(T_world_map), run.path + "/map.3Dscene");
    if (truth && truth->plan)
      report::drawDifference(*truth->plan, run.map, T_world_map, run.method, run.path + "/difference.png",
                             truth->seen ? &*truth->seen : nullptr);
  }
  if (panels.empty()) return;
  report::drawPanels(panels, output + "/maps.png");
  progress.update(-1, 0);
  const world::Plan& ground = truth && truth->plan ? *truth->plan : runs.front().map;
  drawPaths(panels, ground, paths, output + "/paths.png");
  logs::LogReader log(log_path);
  if (const auto entry = log.next()) report::drawScan(entry->scan, output + "/scan.png");
}

/// An output folder is new, or ours to replace, or ours to go on with.
core::OutputLock prepareOutput(const CompareRequest& request) {
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
  core::OutputLock lock(request.output);
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

void scoreByRelations(const std::vector<run::RunFolder>& runs, const core::Relations& relations,
                      const std::string& output, Comparison& comparison) {
  std::vector<RelationScore> scores;
  for (const auto& run : runs)
    for (auto& score : score::scoreByRelations(run, relations)) scores.push_back(std::move(score));
  comparison.relations = relationTable(scores, Detail::kShort);
  comparison.worst_relations = worstRelationsTable(relations, scores, Detail::kShort);
  const auto full = relationTable(scores, Detail::kFull);
  const auto worst = worstRelationsTable(relations, scores, Detail::kFull);
  core::writeFileAtomically(output + "/relations.txt", report::toText(*comparison.relations) + "\n" +
                                                           report::toText(*comparison.worst_relations));
  core::writeFileAtomically(output + "/relations.csv", report::toCsv(full));
  core::writeFileAtomically(output + "/relations.json", report::toJson(full));
  core::writeFileAtomically(output + "/worst_relations.csv", report::toCsv(worst));
}

/// Under the tables: which methods took the kinds of the commands from the wheels, and which took skewed scans.
void noteCommands(const std::vector<run::RunFolder>& runs, const std::vector<report::Table*>& tables) {
  for (const auto& run : runs) {
    const auto from = run.manifest.results.find("commands_from");
    const std::string note =
        from == run.manifest.results.end() ? "" : run::commandsNote(run.method, from->second);
    for (const auto& text : {note, run::skewNote(run.method, run.manifest.results)})
      if (!text.empty())
        for (auto* table : tables) table->notes.push_back(text + ".");
  }
}

}  // namespace

Comparison compare(const CompareRequest& request, core::Manifest manifest, core::Progress& progress) {
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
  core::writeManifest(manifest, request.output + "/manifest.json");

  Comparison comparison;
  comparison.log_path = request.log_path;
  if (plan) {
    comparison.log_path = request.output + "/log/run.rawlog";
    fs::create_directories(request.output + "/log");
    manifest.inputs[request.plan_path] = core::fileSha256(request.plan_path);
    record::record(*plan, request.record, request.seed, comparison.log_path, manifest, progress);
  } else {
    manifest.inputs[request.log_path] = core::fileSha256(request.log_path);
  }
  core::Manifest method_manifest = manifest;
  method_manifest.inputs.clear();
  method_manifest.results.clear();
  for (auto& method : methods) {
    progress.update(-1, 0);
    method.reused = request.resume && isSameRun(method, comparison.log_path, request.seed);
    comparison.reused += method.reused ? 1 : 0;
  }
  runMethods(methods, comparison.log_path, request, method_manifest, progress);

  std::vector<run::RunFolder> runs;
  for (const auto& method : methods) {
    progress.update(-1, 0);
    if (method.failure.empty()) runs.push_back(run::loadRun(method.folder));
  }
  std::string plan_path = request.truth_plan_path.empty() ? request.plan_path : request.truth_plan_path;
  // A recording on a later visit has a true plan of its own.
  if (request.record.living.visit > 1 && request.truth_plan_path.empty()) plan_path.clear();
  const auto truth_files = record::truthFiles(comparison.log_path, request.truth_path, plan_path);
  std::optional<Truth> truth;
  if (!truth_files.trajectory.empty() && !runs.empty())
    truth = loadTruth(truth_files.trajectory, truth_files.plan, runs.front());
  comparison.has_truth = truth.has_value();
  for (const auto& method : methods) {
    progress.update(-1, 0);
    const auto run = std::find_if(runs.begin(), runs.end(),
                                  [&](const run::RunFolder& r) { return r.path == method.folder; });
    comparison.evaluations.push_back(run == runs.end() ? failedEvaluation(method.name, method.failure)
                                                       : evaluate(*run, truth));
    comparison.failed += comparison.evaluations.back().failure.empty() ? 0 : 1;
  }
  setAgreement(runs, comparison.evaluations);
  comparison.accuracy = truth ? accuracyTable(comparison.evaluations, *truth, Detail::kShort)
                              : agreementTable(comparison.evaluations, Detail::kShort);
  comparison.full_accuracy = truth ? accuracyTable(comparison.evaluations, *truth, Detail::kFull)
                                   : agreementTable(comparison.evaluations, Detail::kFull);
  if (!runs.empty()) {
    const std::string steps = runs.front().manifest.results.at("steps_without_odometry");
    if (steps != "0")
      for (auto* table : {&comparison.accuracy, &comparison.full_accuracy})
        table->notes.push_back(steps + " steps of the log come without odometry; methods that want the " +
                               "wheels get increments estimated from the scans there.");
  }
  noteCommands(runs, {&comparison.accuracy, &comparison.full_accuracy});
  if (!relations.empty() && !runs.empty()) {
    manifest.inputs[request.relations_path] = core::fileSha256(request.relations_path);
    scoreByRelations(runs, relations, request.output, comparison);
    if (!truth)
      for (auto* table : {&comparison.accuracy, &comparison.full_accuracy})
        table->caption = "Beside the relations: what can be said without a truth";
  }
  comparison.cost = costTable(comparison.evaluations);
  const std::string scores = request.output + "/scores";
  core::writeFileAtomically(scores + ".txt", report::toText(comparison.accuracy));
  core::writeFileAtomically(scores + ".md", report::toMarkdown(comparison.accuracy));
  core::writeFileAtomically(scores + ".tex",
                            report::toLatex(comparison.accuracy, {"tab:scores", bestMetrics()}));
  core::writeFileAtomically(scores + ".csv", report::toCsv(comparison.full_accuracy));
  core::writeFileAtomically(scores + ".json", report::toJson(comparison.full_accuracy));
  core::writeFileAtomically(request.output + "/cost.csv", report::toCsv(comparison.cost));
  core::writeFileAtomically(request.output + "/cost.json", report::toJson(comparison.cost));
  drawPictures(runs, comparison.evaluations, truth, comparison.log_path, request.output, progress);

  manifest.files["scores.txt"] = "accuracy of every method; also .md, .tex, .csv, .json";
  if (comparison.relations)
    manifest.files["relations.csv"] =
        "error of every path against the relations; also .txt, .json; the worst in worst_relations.csv";
  manifest.files["cost.csv"] = "time and memory of every method; also .json";
  manifest.files["maps.png"] = "the map of every method, side by side";
  manifest.files["paths.png"] = "all paths on one plan";
  manifest.files["scan.png"] = "the first scan: range over angle, and polar";
  manifest.results["status"] = "complete";
  if (truth && !request.truth_path.empty()) manifest.results["truth"] = request.truth_path;
  if (truth && !plan_path.empty()) manifest.results["plan"] = plan_path;
  manifest.results["failed_methods"] = std::to_string(comparison.failed);
  core::writeManifest(manifest, request.output + "/manifest.json");
  return comparison;
}

}  // namespace slam::score
