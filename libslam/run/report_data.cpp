#include "libslam/run/report_data.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/core/files.h"
#include "libslam/core/parameters.h"
#include "libslam/logs/log_reader.h"
#include "libslam/run/compare.h"
#include "libslam/run/evaluate.h"
#include "libslam/run/journal_file.h"

namespace slam::run {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMostPictures = 12;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::string resultOf(const core::Manifest& manifest, const std::string& key) {
  const auto it = manifest.results.find(key);
  return it == manifest.results.end() ? "" : it->second;
}

bool isRunFolder(const std::string& folder) {
  return fs::exists(folder + "/manifest.json") &&
         !resultOf(core::readManifest(folder + "/manifest.json"), "method").empty();
}

/// A method that was asked for, and what became of it.
struct Asked {
  std::string method, folder, failure;
};

/// A table that toMarkdown() wrote, as people saw it.
report::Table readTable(const std::string& path) {
  auto table = report::fromMarkdown(core::readTextFile(path));
  if (table.columns.empty())
    throw core::InputError(path + ": holds no table, expected what rasterslam wrote");
  return table;
}

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
  const auto scores = nlohmann::json::parse(core::readTextFile(path), nullptr, false);
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
std::string logOf(const RunFolder& run, const std::string& folder, report::ReportPage& page) {
  std::vector<std::string> candidates = {folder + "/log/run.rawlog", folder + "/run.rawlog"};
  // A run that goes on in a map names that too.
  for (const auto& [path, hash] : run.manifest.inputs)
    if (fs::path(path).extension() != ".simplemap") candidates.push_back(path);
  for (const auto& path : candidates)
    if (fs::exists(path)) return path;
  page.missing.push_back("The log " + candidates.back() +
                         " is not there any more: no truth, and a replay of paths without scans.");
  return "";
}

/// Rows in the order of their figure, those without one last.
void sortByError(std::vector<Evaluation>& evaluations) {
  const auto error = [](const Evaluation& e) {
    const double rmse = e.final_trajectory.position_m.rmse;
    return std::isnan(rmse) ? std::numeric_limits<double>::infinity() : rmse;
  };
  std::stable_sort(evaluations.begin(), evaluations.end(),
                   [&](const Evaluation& a, const Evaluation& b) { return error(a) < error(b); });
}

std::string metres(double value_m) {
  char text[40];
  if (value_m < 0.1)
    std::snprintf(text, sizeof text, "%.1f mm", 1000 * value_m);
  else if (value_m < 1)
    std::snprintf(text, sizeof text, "%.1f cm", 100 * value_m);
  else
    std::snprintf(text, sizeof text, "%.2f m", value_m);
  return text;
}

std::string percent(double share) {
  char text[40];
  std::snprintf(text, sizeof text, "%.1f %%", 100 * share);
  return text;
}

std::string summaryOf(const Evaluation& e, bool has_truth) {
  if (std::isnan(e.path_length_m)) return "";
  if (!has_truth) return "Its path is " + metres(e.path_length_m) + " long. No truth is known.";
  if (std::isnan(e.final_trajectory.position_m.rmse)) return "Its path cannot be compared with the truth.";
  std::string text = "In the end its path is " + metres(e.final_trajectory.position_m.rmse) +
                     " off (root mean square), " + metres(e.final_trajectory.position_m.max) +
                     " at worst; as it was given online, " + metres(e.trajectory.position_m.rmse) + ".";
  if (!std::isnan(e.map.occupied_precision) && !std::isnan(e.map.occupied_recall))
    text += " Of its walls " + percent(e.map.occupied_precision) + " are true to " +
            metres(kWallTolerance_m) + ", and it has " + percent(e.map.occupied_recall) +
            " of those in view.";
  return text;
}

/// Evaluations in the order of sortByError().
std::vector<std::string> verdictOf(const std::vector<Evaluation>& evaluations, bool has_truth) {
  std::vector<std::string> verdict;
  const auto rmse = [](const Evaluation& e) { return e.final_trajectory.position_m.rmse; };
  const auto scored = static_cast<size_t>(std::count_if(
      evaluations.begin(), evaluations.end(), [&](const Evaluation& e) { return !std::isnan(rmse(e)); }));
  if (!has_truth) {
    verdict.emplace_back(
        "No truth is known for this log, so nobody can say which path is right; the table shows what can be "
        "said without.");
  } else if (scored > 0) {
    const auto& best = evaluations.front();
    std::string text = best.method +
                       (scored > 1 ? " came nearest to the truth: its path is " : "'s path is ") +
                       metres(rmse(best)) + " off in the end (root mean square)";
    if (scored > 1) {
      const auto& second = evaluations[1];
      text += ", that of " + second.method + ", the next, " + metres(rmse(second));
      if (scored > 2)
        text +=
            ", of " + evaluations[scored - 1].method + ", the last, " + metres(rmse(evaluations[scored - 1]));
    }
    verdict.push_back(text + ".");
  }
  for (const auto& e : evaluations)
    if (!e.failure.empty()) verdict.push_back(e.method + " failed: " + e.failure + ".");
  if (evaluations.size() > 1)
    verdict.emplace_back(
        "This is one log with one seed: small differences may be chance, so there are no intervals. "
        "'rasterslam bench' repeats with many seeds.");
  return verdict;
}

/// scan_time_s and scan_ms from timing.csv.
void readTiming(const std::string& path, report::ReportRun& run) {
  if (!fs::exists(path)) return;
  std::istringstream lines(core::readTextFile(path));
  std::string line;
  std::getline(lines, line);
  for (int number = 2; std::getline(lines, line); ++number) {
    const auto first = line.find(','), second = line.find(',', first + 1);
    double time_s = 0, ms = 0;
    if (second == std::string::npos ||
        !core::parseNumber(line.substr(first + 1, second - first - 1), time_s) ||
        !core::parseNumber(line.substr(second + 1), ms))
      throw core::InputError(path + ":" + std::to_string(number) + ": found '" + line +
                             "', expected scan,time_s,cpu_ms");
    run.scan_time_s.push_back(time_s);
    run.scan_ms.push_back(ms);
  }
}

report::ReportRun pageRun(const RunFolder& run, const Evaluation& e, const std::optional<Truth>& truth) {
  report::ReportRun shown;
  shown.method = e.method;
  shown.failure = e.failure;
  shown.summary = summaryOf(e, truth.has_value());
  const core::Pose2 T_world_map = truth ? e.final_trajectory.T_truth_estimate : core::Pose2{};
  shown.map = run.map;
  shown.T_world_map = T_world_map;
  for (const auto& stamped : run.final_estimate.value_or(run.estimate)) {
    shown.path.push_back({stamped.time_s, T_world_map * stamped.pose});
    if (!truth) continue;
    core::Pose2 true_pose;
    const bool known = metrics::poseAt(truth->trajectory, stamped.time_s, true_pose);
    shown.error_m.push_back(known ? core::distance(true_pose, shown.path.back().pose) : kNan);
  }
  readTiming(run.path + "/timing.csv", shown);
  if (fs::exists(run.path + "/journal.csv"))
    for (const auto& line : readJournal(run.path + "/journal.csv"))
      shown.events.push_back({line.scan, line.time_s, line.event, line.value, line.place, line.other_place});
  return shown;
}

/// Evenly chosen among all, so that there are few enough for the player.
void readScans(const std::string& log_path, core::Progress& progress, report::ReportPage& page) {
  const auto info = logs::inspectLog(log_path);
  page.scan_count = info.scans;
  const std::uint64_t kept = std::min<std::uint64_t>(info.scans, report::kMostReplayed);
  logs::LogReader log(log_path);
  progress.begin("reading " + fs::path(log_path).filename().string());
  std::uint64_t number = 0;
  while (auto entry = log.next()) {
    progress.update(log.fractionRead(), entry->scan.time_s - info.first_time_s);
    // The first is always kept: times count from it.
    if (number == 0 || number * kept / info.scans != (number - 1) * kept / info.scans)
      page.scans.push_back(std::move(entry->scan));
    ++number;
  }
  progress.end();
  // In some logs stamps run back; a replay does not.
  std::stable_sort(page.scans.begin(), page.scans.end(),
                   [](const robot::Scan& a, const robot::Scan& b) { return a.time_s < b.time_s; });
}

void addPicture(report::ReportPage& page, const std::string& path, const std::string& caption) {
  if (fs::exists(path)) page.pictures.push_back({caption, core::readTextFile(path)});
}

/// Columns of a CSV of numbers by their names in its first line. Errors: InputError with file and line.
std::vector<std::vector<double>> readColumns(const std::string& path, const std::vector<std::string>& keys) {
  const auto cellsOf = [](std::string line) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    std::vector<std::string> cells(1);
    for (const char c : line) {
      if (c == ',')
        cells.emplace_back();
      else
        cells.back() += c;
    }
    return cells;
  };
  std::istringstream lines(core::readTextFile(path));
  std::string line;
  std::getline(lines, line);
  const auto names = cellsOf(line);
  std::vector<size_t> places;
  for (const auto& key : keys) {
    const auto name = std::find(names.begin(), names.end(), key);
    if (name == names.end()) throw core::InputError(path + ":1: names no column '" + key + "'");
    places.push_back(static_cast<size_t>(name - names.begin()));
  }
  std::vector<std::vector<double>> columns(keys.size());
  for (int number = 2; std::getline(lines, line); ++number) {
    const auto cells = cellsOf(line);
    for (size_t i = 0; i < keys.size(); ++i) {
      double value = kNan;
      const bool there = places[i] < cells.size();
      if (!there || (!cells[places[i]].empty() && !core::parseNumber(cells[places[i]], value)))
        throw core::InputError(path + ":" + std::to_string(number) + ": column '" + keys[i] + "': found '" +
                               (there ? cells[places[i]] : "") + "', expected a number");
      columns[i].push_back(value);
    }
  }
  return columns;
}

/// What an exploration has beside map and path: where it wanted to go, how much it had seen.
void addExploration(const std::string& folder, report::ReportPage& page) {
  if (!fs::exists(folder + "/exploration.csv")) return;
  const auto columns = readColumns(folder + "/exploration.csv", {"time_s", "goal_x_m", "goal_y_m"});
  const core::Pose2 T_world_map = page.runs.empty() ? core::Pose2{} : page.runs.front().T_world_map;
  core::Point2 last{kNan, kNan};
  for (size_t i = 0; i < columns[0].size(); ++i) {
    const core::Point2 goal{columns[1][i], columns[2][i]};
    const bool same = (goal.x == last.x && goal.y == last.y) || (std::isnan(goal.x) && std::isnan(last.x));
    if (!same) page.goals.push_back({columns[0][i] - columns[0][0], T_world_map * goal});
    last = goal;
  }
  addPicture(page, folder + "/coverage.png", "Explored share over time, path and scans.");
  if (fs::exists(folder + "/scores.md"))
    page.tables.insert(page.tables.begin(), readTable(folder + "/scores.md"));
}

void addDownload(report::ReportPage& page, const std::string& path, const std::string& name,
                 const std::string& what, const std::string& media_type) {
  if (fs::exists(path)) page.downloads.push_back({name, what, media_type, core::readTextFile(path)});
}

void addTableDownloads(const std::string& folder, report::ReportPage& page) {
  addDownload(page, folder + "/scores.csv", "scores.csv", "all figures", "text/csv");
  addDownload(page, folder + "/scores.tex", "scores.tex", "the main figures for LaTeX", "application/x-tex");
  addDownload(page, folder + "/relations.csv", "relations.csv", "errors against the relations", "text/csv");
  addDownload(page, folder + "/cost.csv", "cost.csv", "time and memory", "text/csv");
}

void addRunDownloads(const std::vector<RunFolder>& runs, report::ReportPage& page) {
  for (const auto& run : runs) {
    // Saved from the page both lie in one folder with those of other methods.
    auto yaml = core::readTextFile(run.path + "/map.yaml");
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

void addFacts(const core::Manifest& manifest, report::ReportPage& page) {
  page.facts = {{"command", core::shellQuoted(manifest.command_line)},
                {"seed", std::to_string(manifest.seed)},
                {"version", "rasterslam " + manifest.version}};
  for (const auto& [path, hash] : manifest.inputs)
    page.facts.emplace_back("input " + path, "SHA-256 " + hash);
}

std::string titleOf(const std::string& folder, const std::string& what) {
  auto path = fs::weakly_canonical(folder);
  if (path.filename().empty()) path = path.parent_path();
  return what + ": " + path.filename().string();
}

/// The errors against relations, where a comparison was scored by them.
void addRelations(const std::string& folder, report::ReportPage& page) {
  const std::string path = folder + "/relations.json";
  if (!fs::exists(path)) return;
  const auto json = nlohmann::json::parse(core::readTextFile(path), nullptr, false);
  if (!json.is_object() || !json.contains("columns") || !json.contains("rows"))
    throw core::InputError(path + ": is not a table that rasterslam wrote, expected 'columns' and 'rows'");
  report::Table table;
  table.caption = json.value("caption", "");
  table.notes = json.value("notes", std::vector<std::string>());
  for (const auto& column : json["columns"])
    table.columns.push_back({column.value("key", ""), column.value("title", "")});
  for (const auto& row : json["rows"]) {
    table.rows.emplace_back();
    for (const auto& column : table.columns) {
      const auto cell = row.find(column.key);
      if (cell != row.end() && cell->is_string())
        table.rows.back().emplace_back(cell->get<std::string>());
      else
        table.rows.back().emplace_back(cell != row.end() && cell->is_number() ? cell->get<double>() : kNan);
    }
  }
  page.tables.insert(page.tables.begin(), std::move(table));
}

/// Runs, figures and replay of a comparison or of a single run.
void fill(const std::vector<Asked>& methods, const std::string& folder, const core::Manifest& manifest,
          core::Progress& progress, report::ReportPage& page) {
  std::vector<RunFolder> runs;
  for (const auto& method : methods)
    if (method.failure.empty()) runs.push_back(loadRun(method.folder));
  std::string log_path;
  std::optional<Truth> truth;
  if (!runs.empty()) {
    log_path = logOf(runs.front(), folder, page);
    const auto files = truthFiles(log_path, resultOf(manifest, "truth"), resultOf(manifest, "plan"));
    if (!files.trajectory.empty()) truth = loadTruth(files.trajectory, files.plan, runs.front());
  }
  std::vector<Evaluation> evaluations;
  for (const auto& method : methods) {
    const auto run =
        std::find_if(runs.begin(), runs.end(), [&](const RunFolder& r) { return r.path == method.folder; });
    evaluations.push_back(run == runs.end() ? failedEvaluation(method.method, method.failure)
                                            : evaluate(*run, truth));
  }
  setAgreement(runs, evaluations);
  if (truth) sortByError(evaluations);
  page.verdict = verdictOf(evaluations, truth.has_value());
  page.tables = {truth ? accuracyTable(evaluations, *truth, Detail::kShort)
                       : agreementTable(evaluations, Detail::kShort),
                 costTable(evaluations)};
  for (const auto& e : evaluations) {
    const auto run =
        std::find_if(runs.begin(), runs.end(), [&](const RunFolder& r) { return r.method == e.method; });
    if (run != runs.end()) {
      page.runs.push_back(pageRun(*run, e, truth));
    } else {
      page.runs.emplace_back();
      page.runs.back().method = e.method;
      page.runs.back().failure = e.failure;
    }
  }
  if (truth) {
    page.truth = truth->trajectory;
    page.plan = truth->plan;
    page.seen = truth->seen;
  }
  if (!log_path.empty()) readScans(log_path, progress, page);
  addRelations(folder, page);
  addTableDownloads(folder, page);
  addRunDownloads(runs, page);
}

/// Several explorations: their tables and curves.
bool isExplorations(const std::string& folder) {
  return fs::exists(folder + "/runs.csv") && fs::exists(folder + "/scores.md");
}

void fillExplorations(const std::string& folder, report::ReportPage& page) {
  page.title = titleOf(folder, "Explorations");
  page.tables.push_back(readTable(folder + "/scores.md"));
  page.verdict.push_back(
      "This folder holds several explorations; 'rasterslam report' of one of theirs has its replay.");
  addPicture(page, folder + "/coverage.png", "Explored share over time, path and scans.");
  std::vector<std::string> pictures;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().filename() == "path.png") pictures.push_back(entry.path().string());
  std::sort(pictures.begin(), pictures.end());
  if (pictures.size() > kMostPictures)
    page.missing.push_back("Of " + std::to_string(pictures.size()) + " runs the paths of the first " +
                           std::to_string(kMostPictures) + " are shown.");
  pictures.resize(std::min(pictures.size(), kMostPictures));
  for (const auto& path : pictures)
    addPicture(page, path, "Path of " + fs::relative(fs::path(path).parent_path(), folder).string() + ".");
  addTableDownloads(folder, page);
  addDownload(page, folder + "/runs.csv", "runs.csv", "every run", "text/csv");
}

/// A sweep of bench(): statistics over the seeds, with intervals.
void fillSweep(const std::string& folder, const core::Manifest& manifest, report::ReportPage& page) {
  page.title = titleOf(folder, "Sweep");
  page.tables.push_back(readTable(folder + "/summary.md"));
  page.verdict.push_back(resultOf(manifest, "runs") +
                         " runs: statistics over the seeds, with 95 % intervals.");
  const auto missing = resultOf(manifest, "missing"), failed = resultOf(manifest, "failed");
  if (!missing.empty() && missing != "0")
    page.missing.push_back("This sweep is not finished: " + missing +
                           " runs are missing. 'rasterslam bench ... --resume' goes on with it.");
  if (!failed.empty() && failed != "0") page.verdict.push_back(failed + " runs failed.");
  std::vector<std::string> pictures;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".png") pictures.push_back(entry.path().string());
  std::sort(pictures.begin(), pictures.end());
  for (const auto& path : pictures) addPicture(page, path, fs::path(path).filename().string());
  for (const char* name : {"summary.csv", "summary.tex", "results.csv", "cost.csv"})
    addDownload(page, folder + "/" + name, name, "",
                name == std::string("summary.tex") ? "application/x-tex" : "text/csv");
}

}  // namespace

report::ReportPage gatherReport(const std::string& folder, core::Progress& progress) {
  if (!fs::is_directory(folder))
    throw core::InputError(folder + ": is not a folder, expected one that rasterslam wrote");
  const std::string manifest_path = folder + "/manifest.json";
  if (!fs::exists(manifest_path))
    throw core::InputError(folder +
                           ": holds no manifest.json, expected the folder of a compare, run or explore");
  const auto manifest = core::readManifest(manifest_path);
  report::ReportPage page;
  addFacts(manifest, page);
  page.subtitle = "Written by rasterslam " + manifest.version +
                  ". Paths and maps are laid on the truth, where one is known, "
                  "by least squares without scale.";
  const std::string method = resultOf(manifest, "method");
  if (!method.empty()) {
    page.title = titleOf(folder, method);
    fill({{method, folder, ""}}, folder, manifest, progress, page);
    addExploration(folder, page);
    return page;
  }
  if (fs::exists(folder + "/summary.md")) {
    fillSweep(folder, manifest, page);
    return page;
  }
  if (isExplorations(folder)) {
    fillExplorations(folder, page);
    return page;
  }
  const auto methods = methodsOfComparison(folder, page);
  if (methods.empty()) {
    throw core::InputError(folder + ": holds no run, expected the folder of a compare, run or explore");
  }
  page.title = titleOf(folder, "Comparison");
  fill(methods, folder, manifest, progress, page);
  return page;
}

}  // namespace slam::run
