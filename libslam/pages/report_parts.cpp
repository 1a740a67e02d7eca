#include "libslam/pages/report_parts.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/files/csv.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"
#include "libslam/logs/log_reader.h"
#include "libslam/record/record.h"
#include "libslam/resources/json_entry.h"
#include "libslam/sim/operation_log.h"
#include "libslam/truth/carry_file.h"
#include "libslam/truth/collision_file.h"
#include "libslam/truth/truth_files.h"

namespace slam::pages {
namespace fs = std::filesystem;
namespace {

using core::kNaN;

std::string operationText(const sim::Operation& operation) {
  const auto number = [](double value) { return ' ' + table::shownText(value, {"", "", 4}); };
  std::string text = operation.kind + number(operation.first);
  if (operation.kind != 't') text += number(operation.second);
  if (operation.kind == 'a') text += number(operation.third);
  return text;
}

/// The whole command that each of the log's scans was taken after or during; none where the two do not belong
/// together.
std::vector<std::string> readOperations(const std::string& log_path, std::uint64_t scans) {
  const std::string path = truth::besideLog(log_path, ".operations.txt");
  if (!fs::exists(path)) return {};
  const auto operations = sim::parseOperations(files::readTextFile(path), path);
  const bool numbered = !operations.empty() && operations.front().scan_after > 0;
  if (!numbered && operations.size() + 1 != scans) return {};
  std::vector<std::string> texts(scans);
  for (size_t i = 0; i < operations.size(); ++i) {
    const auto before = numbered ? operations[i].scan_before : i;
    const auto after = numbered ? operations[i].scan_after : i + 1;
    if (after >= scans) return {};
    std::fill(texts.begin() + static_cast<std::ptrdiff_t>(before) + 1,
              texts.begin() + static_cast<std::ptrdiff_t>(after) + 1, operationText(operations[i]));
  }
  return texts;
}

void addCollisions(const std::string& log_path, double start_s, report::ReportReplay& replay) {
  for (const auto& collision : truth::readCollisions(truth::collisionsPath(log_path)))
    replay.moments.push_back(
        {collision.time_s - start_s, "collision", "", core::position(collision.T_world_robot)});
  for (const auto& carry : truth::readCarryFile(truth::carriesPath(log_path)))
    replay.moments.push_back({carry.time_s - start_s, "kidnapped", truth::carryText(carry, start_s),
                              core::position(carry.T_world_to)});
}

}  // namespace

std::string resultOf(const resources::Manifest& manifest, const std::string& key) {
  const auto it = manifest.results.find(key);
  return it == manifest.results.end() ? "" : it->second;
}

std::string pageTitle(const std::string& folder, const std::string& what) {
  auto path = fs::weakly_canonical(folder);
  if (path.filename().empty()) path = path.parent_path();
  return what + ": " + path.filename().string();
}

table::Table readMarkdownTable(const std::string& path) {
  auto table = table::fromMarkdown(files::readTextFile(path));
  if (table.columns.empty())
    throw core::InputError(path + ": holds no table, expected what rasterslam wrote");
  return table;
}

table::Table readJsonTable(const std::string& path) {
  const auto json = resources::readJsonFile(path);
  const auto isList = [&](const char* key) {
    return json.is_object() && json.contains(key) && json[key].is_array() &&
           std::all_of(json[key].begin(), json[key].end(), [](const auto& one) { return one.is_object(); });
  };
  if (!isList("columns") || !isList("rows"))
    throw core::InputError(path + ": is not a table that rasterslam wrote, expected 'columns' and 'rows'");
  table::Table table;
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
        table.rows.back().emplace_back(cell != row.end() && cell->is_number() ? cell->get<double>() : kNaN);
    }
  }
  return table;
}

std::string textIn(const table::CellValue& cell) {
  const auto* text = std::get_if<std::string>(&cell);
  return text != nullptr ? *text : "";
}

void addPicture(report::ReportPage& page, const std::string& path, const std::string& caption) {
  if (fs::exists(path)) page.pictures.push_back({caption, files::readTextFile(path)});
}

void addDownload(report::ReportPage& page, const std::string& path, const std::string& name,
                 const std::string& what, const std::string& media_type) {
  if (fs::exists(path)) page.downloads.push_back({name, what, media_type, files::readTextFile(path)});
}

void addTableDownloads(const std::string& folder, report::ReportPage& page) {
  addDownload(page, folder + "/scores.csv", "scores.csv", "all figures", "text/csv");
  addDownload(page, folder + "/scores.tex", "scores.tex", "the main figures for LaTeX", "application/x-tex");
  addDownload(page, folder + "/relations.csv", "relations.csv", "errors against the relations", "text/csv");
  addDownload(page, folder + "/cost.csv", "cost.csv", "time and memory", "text/csv");
}

void readReplay(const std::string& log_path, std::size_t most, core::Progress& progress,
                report::ReportReplay& replay) {
  const auto info = logs::inspectLog(log_path);
  replay.scan_count = info.scans;
  const std::uint64_t kept = std::min<std::uint64_t>(info.scans, most);
  const auto operations = readOperations(log_path, info.scans);
  struct Shown {
    lidar::Scan scan;
    std::string operation;
  };
  std::vector<Shown> shown;
  logs::LogReader log(log_path);
  progress.begin("reading " + fs::path(log_path).filename().string());
  std::uint64_t number = 0;
  while (auto entry = log.next()) {
    progress.update(log.fractionRead(), entry->scan.time_s - info.first_time_s);
    // The first is always kept: times count from it.
    if (number == 0 || number * kept / info.scans != (number - 1) * kept / info.scans)
      shown.push_back({std::move(entry->scan), operations.empty() ? "" : operations[number]});
    ++number;
  }
  progress.end();
  // In some logs stamps run back; a replay does not.
  std::stable_sort(shown.begin(), shown.end(),
                   [](const Shown& a, const Shown& b) { return a.scan.time_s < b.scan.time_s; });
  for (auto& one : shown) {
    replay.scans.push_back(std::move(one.scan));
    if (!operations.empty()) replay.operations.push_back(std::move(one.operation));
  }
  if (!replay.scans.empty()) addCollisions(log_path, replay.scans.front().time_s, replay);
}

void addGoals(const std::string& folder, const core::Pose2& T_world_map, report::ReportReplay& replay) {
  const auto curve = files::CsvTable::read(folder + "/exploration.csv");
  const auto time_s = curve.numbersOrNan("time_s"), x = curve.numbersOrNan("goal_x_m"),
             y = curve.numbersOrNan("goal_y_m");
  core::Point2 last{kNaN, kNaN};
  for (size_t i = 0; i < time_s.size(); ++i) {
    const core::Point2 goal{x[i], y[i]};
    const bool same = (goal.x == last.x && goal.y == last.y) || (std::isnan(goal.x) && std::isnan(last.x));
    if (!same) replay.goals.push_back({time_s[i] - time_s[0], T_world_map * goal});
    last = goal;
  }
  if (time_s.empty() || !fs::exists(folder + "/decisions.csv")) return;
  const auto decisions = files::CsvTable::read(folder + "/decisions.csv");
  const auto at_s = decisions.numbersOrNan("time_s"), goal_x = decisions.numbersOrNan("goal_x_m"),
             goal_y = decisions.numbersOrNan("goal_y_m");
  const auto reasons =
      decisions.has("reason") ? decisions.texts("reason") : std::vector<std::string>(at_s.size());
  for (size_t i = 0; i < at_s.size(); ++i)
    replay.moments.push_back(
        {at_s[i] - time_s[0], "decision", reasons[i], T_world_map * core::Point2{goal_x[i], goal_y[i]}});
}

}  // namespace slam::pages
