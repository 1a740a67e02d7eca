#include "libslam/pages/report_data.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>

#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/files/csv.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"
#include "libslam/pages/report_meanings.h"
#include "libslam/pages/report_parts.h"
#include "libslam/pages/report_verdict.h"
#include "libslam/resources/json_entry.h"
#include "libslam/results/journal_file.h"
#include "libslam/score/compare.h"
#include "libslam/score/evaluate.h"
#include "libslam/truth/truth_files.h"

namespace slam::pages {
namespace fs = std::filesystem;
namespace {

using core::kNaN;

bool isRunFolder(const std::string& folder) {
  return fs::exists(folder + "/manifest.json") &&
         !resultOf(resources::readManifest(folder + "/manifest.json"), "method").empty();
}

/// A method that was asked for, and what became of it.
struct Asked {
  std::string method, folder, failure;
};

/// Why a method has no figures, from the notes of its comparison's table.
std::string failureIn(const nlohmann::json& scores, const std::string& method) {
  const std::string beginning = method + " failed: ";
  for (const auto& note : scores.value("notes", std::vector<std::string>()))
    if (note.rfind(beginning, 0) == 0) return note.substr(beginning.size());
  return "its folder is not there";
}

std::vector<Asked> methodsOfComparison(const std::string& folder, report::ReportPage& page) {
  std::vector<Asked> methods;
  const std::string path = folder + "/scores.json";
  if (!fs::exists(path)) {
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.is_directory() && isRunFolder(entry.path().string()))
        methods.push_back({entry.path().filename().string(), entry.path().string(), ""});
    std::sort(methods.begin(), methods.end(),
              [](const Asked& a, const Asked& b) { return a.method < b.method; });
    page.missing.emplace_back(
        "This comparison is not finished: only the methods that have ended are here. 'rasterslam compare ... "
        "--resume' goes on with it.");
    return methods;
  }
  const auto scores = resources::readJsonFile(path);
  if (!scores.is_object() || !scores.contains("rows") || !scores["rows"].is_array())
    throw core::InputError(path + ": is not a table that rasterslam wrote, expected an object with 'rows'");
  for (const auto& row : scores["rows"]) {
    if (!row.is_object() || !row.contains("method") || !row["method"].is_string())
      throw core::InputError(path + ": a row names no method, expected key 'method'");
    const auto name = row["method"].get<std::string>();
    const std::string of_method = folder + "/" + name;
    if (isRunFolder(of_method))
      methods.push_back({name, of_method, ""});
    else
      methods.push_back({name, "", failureIn(scores, name)});
  }
  return methods;
}

/// The log that a run read; "" with a word on the page where it is gone.
std::string logOf(const results::RunFolder& run, const std::string& folder, report::ReportPage& page) {
  std::vector<std::string> candidates = {folder + "/log/run.rawlog", folder + "/run.rawlog"};
  if (const auto path = results::logInput(run.manifest); !path.empty()) candidates.push_back(path);
  for (const auto& path : candidates)
    if (fs::exists(path)) return path;
  page.missing.push_back("The log " + candidates.back() +
                         " is not there any more: no truth, and a replay of paths without scans.");
  return "";
}

/// scan_time_s and scan_ms from timing.csv.
void readTiming(const std::string& path, report::ReportRun& run) {
  if (!fs::exists(path)) return;
  const std::string text = files::readTextFile(path);
  files::CsvReader reader(text, path);
  std::vector<std::string> fields;
  reader.next(fields);
  while (reader.next(fields)) {
    double time_s = 0, ms = 0;
    if (fields.size() != 3 || !files::parseNumber(fields[1], time_s) || !files::parseNumber(fields[2], ms))
      throw core::InputError(reader.place() + ": found '" + std::string(reader.record()) +
                             "', expected scan,time_s,cpu_ms");
    run.scan_time_s.push_back(time_s);
    run.scan_ms.push_back(ms);
  }
}

report::ReportRun pageRun(const results::RunFolder& run, const score::Evaluation& e,
                          const std::optional<score::Truth>& truth) {
  report::ReportRun shown;
  shown.method = e.method;
  shown.failure = e.failure;
  shown.summary = summaryOf(e, truth.has_value());
  const core::Pose2 T_world_map = truth ? e.final_trajectory.T_truth_estimate : core::Pose2{};
  shown.map = run.map;
  shown.T_world_map = T_world_map;
  if (run.final_estimate)
    for (const auto& stamped : run.estimate)
      shown.online.push_back({stamped.time_s, T_world_map * stamped.pose});
  for (const auto& stamped : run.final_estimate.value_or(run.estimate)) {
    shown.path.push_back({stamped.time_s, T_world_map * stamped.pose});
    if (!truth) continue;
    core::Pose2 true_pose;
    const bool known = metrics::poseAt(truth->trajectory, stamped.time_s, true_pose);
    shown.error_m.push_back(known ? core::distance(true_pose, shown.path.back().pose) : kNaN);
  }
  if (truth) {
    const auto errors = score::statedErrors(run, *truth, score::alignmentOf(run.manifest));
    shown.nees = errors.online, shown.nees_final = errors.final_poses;
  }
  readTiming(run.path + "/timing.csv", shown);
  if (fs::exists(run.path + "/journal.csv")) shown.events = results::readJournal(run.path + "/journal.csv");
  return shown;
}

void addRunDownloads(const std::vector<results::RunFolder>& runs, report::ReportPage& page) {
  for (const auto& run : runs) {
    // Saved from the page both lie in one folder with those of other methods.
    auto yaml = files::readTextFile(run.path + "/map.yaml");
    yaml = std::regex_replace(yaml, std::regex("(^|\n)image:[^\n]*"), "$1image: " + run.method + "_map.png");
    page.downloads.push_back(
        {run.method + "_map.yaml", "the map for ROS, with the picture", "application/yaml", yaml});
    addDownload(page, run.path + "/map.png", run.method + "_map.png", "its picture", "image/png");
  }
  for (const auto& run : runs) {
    const std::string name = run.final_estimate ? "trajectory_final.tum" : "trajectory.tum";
    addDownload(page, run.path + "/" + name, run.method + "_" + name, "the path, TUM form", "text/plain");
  }
}

void addFacts(const resources::Manifest& manifest, report::ReportPage& page) {
  page.facts = {{"command", resources::shellQuoted(manifest.command_line)},
                {"seed", std::to_string(manifest.seed)},
                {"version", "rasterslam " + manifest.version}};
  for (const auto& [path, hash] : manifest.inputs)
    page.facts.emplace_back("input " + path, "SHA-256 " + hash);
}

/// Runs, figures and replay of a comparison or of a single run.
void fill(const std::vector<Asked>& methods, const std::string& folder, const resources::Manifest& manifest,
          core::Progress& progress, report::ReportPage& page) {
  std::vector<results::RunFolder> runs;
  for (const auto& method : methods)
    if (method.failure.empty()) runs.push_back(results::loadRun(method.folder));
  std::string log_path;
  std::optional<score::Truth> truth;
  if (!runs.empty()) {
    log_path = logOf(runs.front(), folder, page);
    const auto files = truth::truthFiles(log_path, resultOf(manifest, "truth"), resultOf(manifest, "plan"));
    if (!files.trajectory.empty()) truth = score::loadTruth(files.trajectory, files.plan, runs.front());
  }
  std::vector<score::Evaluation> evaluations;
  for (const auto& method : methods) {
    const auto run = std::find_if(runs.begin(), runs.end(),
                                  [&](const results::RunFolder& r) { return r.path == method.folder; });
    evaluations.push_back(run == runs.end() ? score::failedEvaluation(method.method, method.failure)
                                            : score::evaluate(*run, truth));
  }
  score::setAgreement(runs, evaluations);
  sortByWorth(evaluations, truth.has_value());
  page.verdict = verdictOf(evaluations, truth.has_value());
  page.tables = {truth ? score::accuracyTable(evaluations, *truth, score::Detail::kShort)
                       : score::agreementTable(evaluations, score::Detail::kShort),
                 score::costTable(evaluations)};
  const auto isNone = [](const table::CellValue& cell) {
    const auto* number = std::get_if<double>(&cell);
    return number != nullptr && std::isnan(*number);
  };
  const auto& costs = page.tables.back().rows;
  if (std::all_of(costs.begin(), costs.end(),
                  [&](const auto& row) { return std::all_of(row.begin() + 1, row.end(), isNone); }))
    page.tables.pop_back();  // an exploration does not measure them
  for (const auto& e : evaluations) {
    const auto run = std::find_if(runs.begin(), runs.end(),
                                  [&](const results::RunFolder& r) { return r.method == e.method; });
    if (run != runs.end()) {
      page.runs.push_back(pageRun(*run, e, truth));
    } else {
      page.runs.emplace_back();
      page.runs.back().method = e.method;
      page.runs.back().failure = e.failure;
    }
  }
  auto& replay = page.replays.emplace_back();
  if (truth) {
    replay.truth = truth->trajectory;
    replay.plan = truth->plan;
    replay.seen = truth->seen;
  }
  if (!log_path.empty()) readReplay(log_path, report::kMostReplayed, progress, replay);
  if (fs::exists(folder + "/relations.json"))
    page.tables.insert(page.tables.begin(), readJsonTable(folder + "/relations.json"));
  addTableDownloads(folder, page);
  addRunDownloads(runs, page);
}

/// What an exploration has beside map and path: where it wanted to go, how much it had seen.
void addExploration(const std::string& folder, report::ReportPage& page) {
  if (!fs::exists(folder + "/exploration.csv")) return;
  const core::Pose2 T_world_map = page.runs.empty() ? core::Pose2{} : page.runs.front().T_world_map;
  addGoals(folder, T_world_map, page.replays.front());
  addCoverage({folder}, {"explored"}, page);
  const auto manifest = resources::readManifest(folder + "/manifest.json");
  double share = kNaN;
  if (files::parseNumber(resultOf(manifest, "coverage"), share)) {
    std::string text = resultOf(manifest, "strategy") + " explored " + percent(share) +
                       " of what can be explored; it ended by: " + resultOf(manifest, "end");
    if (const auto detail = resultOf(manifest, "end_detail"); !detail.empty()) text += " (" + detail + ")";
    page.verdict.insert(page.verdict.begin(), text + ".");
  }
  if (fs::exists(folder + "/scores.md"))
    page.tables.insert(page.tables.begin(), readMarkdownTable(folder + "/scores.md"));
}

}  // namespace

void addRun(const std::string& folder, const std::string& log_path, const std::string& name,
            std::size_t replay, report::ReportPage& page) {
  const auto run = results::loadRun(folder);
  auto files = truth::truthFiles(log_path, "", "");
  // Where a sweep generated the building.
  if (const auto plan = fs::path(log_path).parent_path() / "plan.yaml";
      files.plan.empty() && fs::exists(plan))
    files.plan = plan.string();
  std::optional<score::Truth> truth;
  if (!files.trajectory.empty()) truth = score::loadTruth(files.trajectory, files.plan, run);
  page.runs.push_back(pageRun(run, score::evaluate(run, truth), truth));
  page.runs.back().method = name;
  page.runs.back().replay = replay;
  if (!truth) return;
  page.replays[replay].truth = truth->trajectory;
  page.replays[replay].plan = truth->plan;
  page.replays[replay].seen = truth->seen;
}

namespace {

/// What tune() writes beside its sweeps.
bool isTuning(const std::string& folder) {
  return fs::exists(folder + "/candidates.json") && fs::exists(folder + "/verdict.txt");
}

report::ReportPage tuningPage(const std::string& folder) {
  report::ReportPage page;
  page.title = pageTitle(folder, "Tuning");
  page.subtitle =
      "Candidates were ranked on training worlds, the best judged against the default on held-out ones.";
  page.verdict = {files::trimmed(files::readTextFile(folder + "/verdict.txt"))};
  for (const std::string name : {"candidates", "sensitivity"})
    if (fs::exists(folder + "/" + name + ".json"))
      page.tables.push_back(readJsonTable(folder + "/" + name + ".json"));
  if (fs::exists(folder + "/held_out/summary.md"))
    page.tables.push_back(readMarkdownTable(folder + "/held_out/summary.md"));
  return page;
}

report::ReportPage pageOf(const std::string& folder, core::Progress& progress) {
  if (!fs::is_directory(folder))
    throw core::InputError(folder + ": is not a folder, expected one that rasterslam wrote");
  if (isTuning(folder)) return tuningPage(folder);
  const std::string manifest_path = folder + "/manifest.json";
  if (!fs::exists(manifest_path))
    throw core::InputError(folder +
                           ": holds no manifest.json, expected the folder of a compare, run, explore, "
                           "navigate, bench or stress");
  const auto manifest = resources::readManifest(manifest_path);
  report::ReportPage page;
  addFacts(manifest, page);
  page.subtitle = "Written by rasterslam " + manifest.version +
                  ". Paths and maps are laid on the truth, where one is known, "
                  "by least squares without scale.";
  const std::string method = resultOf(manifest, "method");
  if (!method.empty()) {
    page.title = pageTitle(folder, method);
    fill({{method, folder, ""}}, folder, manifest, progress, page);
    addExploration(folder, page);
    return page;
  }
  if (isSweep(folder)) {
    fillSweep(folder, manifest, progress, page);
    return page;
  }
  if (isExplorations(folder)) {
    fillExplorations(folder, progress, page);
    return page;
  }
  if (isNavigation(folder)) {
    fillNavigation(folder, manifest, page);
    return page;
  }
  const auto methods = methodsOfComparison(folder, page);
  if (methods.empty()) {
    throw core::InputError(folder + ": holds no run, expected the folder of a compare, run or explore");
  }
  page.title = pageTitle(folder, "Comparison");
  fill(methods, folder, manifest, progress, page);
  return page;
}

}  // namespace

report::ReportPage gatherReport(const std::string& folder, core::Progress& progress) {
  auto page = pageOf(folder, progress);
  addMeanings(page);
  return page;
}

}  // namespace slam::pages
