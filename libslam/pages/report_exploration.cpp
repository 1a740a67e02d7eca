#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/files/csv.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/metrics/trajectory_error.h"
#include "libslam/pages/report_parts.h"
#include "libslam/table/cells.h"
#include "libslam/world/plan.h"

namespace slam::pages {
namespace fs = std::filesystem;
namespace {

using core::kNaN;

/// One exploration of several.
struct Explored {
  std::string strategy, folder;
  std::string label;  ///< "wall_follow" or "wall_follow, seed 2"
};

/// Those whose folders are there, the first seed of every strategy first.
std::vector<Explored> exploredIn(const std::string& folder, const files::CsvTable& runs) {
  const auto strategies = runs.texts("strategy"), seeds = runs.texts("seed");
  std::vector<std::pair<int, Explored>> found;
  for (size_t i = 0; i < strategies.size(); ++i) {
    const auto earlier =
        std::count(strategies.begin(), strategies.begin() + static_cast<std::ptrdiff_t>(i), strategies[i]);
    const bool is_one = std::count(strategies.begin(), strategies.end(), strategies[i]) == 1;
    const std::string path = folder + "/" + strategies[i] + (is_one ? "" : "/seed_" + seeds[i]);
    if (!fs::exists(path + "/exploration.csv")) continue;
    found.push_back({static_cast<int>(earlier),
                     {strategies[i], path, strategies[i] + (is_one ? "" : ", seed " + seeds[i])}});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Explored> explored;
  explored.reserve(found.size());
  for (auto& [round, one] : found) explored.push_back(std::move(one));
  return explored;
}

/// One row per strategy; where a figure has quartiles they stand in its cell.
table::Table explorationsTable(const std::string& path) {
  const auto all = readJsonTable(path);
  struct Shown {
    const char *key, *title;
    int decimals;
  };
  const Shown shown[] = {{"coverage_percent", "explored (%)", 1},
                         {"t90_s", "90 % after (s)", 0},
                         {"t99_s", "99 % after (s)", 0},
                         {"path90_m", "90 % after (m)", 1},
                         {"path99_m", "99 % after (m)", 1},
                         {"path_m", "path (m)", 1},
                         {"redundant_percent", "redundant (%)", 0},
                         {"collisions", "collisions", 0},
                         {"near_misses", "near misses", 0},
                         {"decisions", "decisions", 0},
                         {"ate_rmse_m", "ATE (m)", 3},
                         {"wall_f1", "wall F1", 3}};
  table::Table table;
  table.caption = all.caption;
  const std::string in_text_tables = ", below them the quartiles";
  for (auto note : all.notes) {
    if (const auto at = note.find(in_text_tables); at != std::string::npos)
      note.replace(at, in_text_tables.size(), ", in brackets the quartiles");
    table.notes.push_back(note);
  }
  table.columns = {{"strategy", "strategy"}, {"runs", "runs", 0}, {"failed", "failed", 0}};
  for (const auto& one : shown) table.columns.push_back({one.key, one.title, one.decimals});
  table.columns.push_back({"ends", "ends"});
  const auto cell = [&](const auto& row, const std::string& key) {
    return row[table::columnOf(all, key, path)];
  };
  for (const auto& row : all.rows) {
    table.rows.push_back({cell(row, "strategy"), cell(row, "runs"), cell(row, "failed")});
    const bool is_one = table::numberOf(cell(row, "runs")) < 2;
    for (const auto& one : shown) {
      const table::Column column{"", "", one.decimals};
      const auto text = [&](const std::string& key) { return table::shownText(cell(row, key), column); };
      const std::string key = one.key;
      if (is_one || std::isnan(table::numberOf(cell(row, key))))
        table.rows.back().push_back(cell(row, key));
      else
        table.rows.back().emplace_back(text(key) + " [" + text(key + "_q1") + ", " + text(key + "_q3") + "]");
    }
    table.rows.back().push_back(cell(row, "ends"));
  }
  return table;
}

std::string verdictOf(const table::Table& table, const std::string& path) {
  const auto coverage = table::columnOf(table, "coverage_percent", path),
             t90 = table::columnOf(table, "t90_s", path), path90 = table::columnOf(table, "path90_m", path);
  const auto value = [](const table::CellValue& cell) {
    const double number = table::numberOf(cell);
    return std::isnan(number) ? HUGE_VAL : number;
  };
  const auto earliest =
      std::min_element(table.rows.begin(), table.rows.end(),
                       [&](const auto& a, const auto& b) { return value(a[t90]) < value(b[t90]); });
  if (earliest == table.rows.end()) return "No exploration has ended.";
  const auto number = [](const table::CellValue& cell, int decimals) {
    return table::shownText(cell, {"", "", decimals});
  };
  if (!std::isnan(table::numberOf((*earliest)[t90])))
    return textIn((*earliest)[table::columnOf(table, "strategy", path)]) +
           " was the first to see 90 % of what can be explored, after " + number((*earliest)[t90], 0) +
           " s and " + number((*earliest)[path90], 1) + " m of way; at the end it had seen " +
           number((*earliest)[coverage], 1) + " %.";
  const auto most = std::max_element(table.rows.begin(), table.rows.end(), [&](const auto& a, const auto& b) {
    return table::numberOf(a[coverage]) < table::numberOf(b[coverage]);
  });
  return "None saw 90 % of what can be explored; " +
         textIn((*most)[table::columnOf(table, "strategy", path)]) + " saw most, " +
         number((*most)[coverage], 1) + " %.";
}

std::optional<core::Point2> goalOf(const resources::Manifest& manifest) {
  core::Point2 goal;
  if (!files::parseNumber(resultOf(manifest, "goal_x_m"), goal.x) ||
      !files::parseNumber(resultOf(manifest, "goal_y_m"), goal.y))
    return std::nullopt;
  return goal;
}

std::string planOf(const resources::Manifest& manifest) {
  for (const auto& [path, hash] : manifest.inputs)
    if (fs::exists(path)) return path;
  return "";
}

}  // namespace

bool isExplorations(const std::string& folder) {
  return fs::exists(folder + "/runs.csv") && fs::exists(folder + "/scores.json");
}

void addCoverage(const std::vector<std::string>& folders, const std::vector<std::string>& labels,
                 report::ReportPage& page) {
  constexpr double kPercent = 100;
  report::PageChart over_path{"coverage-path",
                              "Explored share over the path that the robot drove.",
                              "path (m)",
                              "explored (%)",
                              {},
                              kPercent,
                              0};
  report::PageChart over_time{
      "coverage-time", "Explored share over time.", "time (s)", "explored (%)", {}, kPercent, 0};
  for (size_t i = 0; i < folders.size(); ++i) {
    const auto curve = files::CsvTable::read(folders[i] + "/exploration.csv");
    const auto time_s = curve.numbersOrNan("time_s"), path_m = curve.numbersOrNan("path_m"),
               share = curve.numbersOrNan("explored_share");
    report::PageCurve by_path, by_time;
    by_path.label = by_time.label = labels[i];
    for (size_t k = 0; k < share.size(); ++k) {
      by_path.points.push_back({path_m[k], kPercent * share[k]});
      by_time.points.push_back({time_s[k] - time_s[0], kPercent * share[k]});
    }
    over_path.curves.push_back(std::move(by_path));
    over_time.curves.push_back(std::move(by_time));
  }
  if (folders.size() == 1 && !over_time.curves[0].points.empty())
    over_time.duration_s = over_time.curves[0].points.back().x;
  page.charts.push_back(std::move(over_path));
  page.charts.push_back(std::move(over_time));
}

void fillExplorations(const std::string& folder, core::Progress& progress, report::ReportPage& page) {
  page.title = pageTitle(folder, "Explorations");
  page.tables.push_back(explorationsTable(folder + "/scores.json"));
  page.verdict.push_back(verdictOf(readJsonTable(folder + "/scores.json"), folder + "/scores.json"));
  const auto runs = files::CsvTable::read(folder + "/runs.csv");
  const auto explored = exploredIn(folder, runs);
  const auto rows = runs.texts("strategy").size();
  if (explored.empty()) {
    // --tables-only, or cleared away
    page.missing.emplace_back(
        "The runs' folders are not there (--tables-only leaves them out): no curves and no replay.");
    addPicture(page, folder + "/coverage.png", "Explored share over time, path and scans.");
  } else if (explored.size() < rows) {
    page.missing.push_back("Of " + std::to_string(rows) + " runs " + std::to_string(rows - explored.size()) +
                           " left no folder; they are in no curve.");
  }
  // A strategy's runs share its colour.
  std::vector<std::string> folders, labels;
  for (const auto& one : explored) {
    folders.push_back(one.folder);
    labels.push_back(one.strategy);
  }
  if (!folders.empty()) addCoverage(folders, labels, page);
  const size_t shown = std::min(explored.size(), kMostReplays);
  for (size_t i = 0; i < shown; ++i) {
    auto& replay = page.replays.emplace_back();
    replay.name = explored[i].label;
    const std::string log_path = explored[i].folder + "/run.rawlog";
    addRun(explored[i].folder, log_path, explored[i].label, i, page);
    if (fs::exists(log_path)) readReplay(log_path, report::kMostReplayed / shown, progress, page.replays[i]);
    addGoals(explored[i].folder, page.runs.back().T_world_map, page.replays[i]);
  }
  if (shown < explored.size())
    page.left_out.push_back("To keep this page small it has maps and replay of " + std::to_string(shown) +
                            " of " + std::to_string(explored.size()) + " runs only; 'rasterslam report " +
                            explored[shown].folder + "' shows the next, and so on.");
  addTableDownloads(folder, page);
  addDownload(page, folder + "/runs.csv", "runs.csv", "every run", "text/csv");
}

bool isNavigation(const std::string& folder) {
  if (!fs::exists(folder + "/scores.md")) return false;
  const auto entries = fs::directory_iterator(folder);
  return std::any_of(begin(entries), end(entries),
                     [](const auto& entry) { return fs::exists(entry.path() / "states.csv"); });
}

void fillNavigation(const std::string& folder, const resources::Manifest& manifest,
                    report::ReportPage& page) {
  page.title = pageTitle(folder, "Drives to a goal");
  page.subtitle = "The true paths, and those by the pose that each method was given.";
  const std::string scores = folder + "/scores.md";
  page.tables.push_back(readMarkdownTable(scores));
  const auto& table = page.tables.back();
  const auto goal = goalOf(manifest);
  std::optional<world::Plan> plan;
  const auto plan_path = planOf(manifest);
  if (plan_path.empty())
    page.missing.emplace_back("The plan is not there any more: the paths stand on nothing.");
  else
    plan = world::loadPlan(plan_path);
  for (const auto& row : table.rows) {
    const auto method = textIn(row[table::columnOf(table, "method", scores)]);
    const auto result = resultOf(manifest, method);
    if (!result.empty()) page.verdict.push_back(method + ": " + result + ".");
    const std::string of_method = folder + "/" + method;
    if (!fs::exists(of_method + "/truth.tum")) {
      page.missing.push_back(of_method + " is not there: no path of " + method + ".");
      continue;
    }
    auto& replay = page.replays.emplace_back();
    replay.name = method;
    replay.plan = plan;
    replay.truth = logs::readTum(of_method + "/truth.tum");
    if (goal) replay.goals.push_back({0, *goal});
    report::ReportRun run;
    run.method = method;
    run.replay = page.replays.size() - 1;
    run.path = logs::readTum(of_method + "/trajectory.tum");
    for (const auto& stamped : run.path) {
      core::Pose2 true_pose;
      const bool known = metrics::poseAt(replay.truth, stamped.time_s, true_pose);
      run.error_m.push_back(known ? core::distance(true_pose, stamped.pose) : kNaN);
    }
    const auto states = files::CsvTable::read(of_method + "/states.csv");
    const auto time_s = states.numbersOrNan("time_s"), x = states.numbersOrNan("x_m"),
               y = states.numbersOrNan("y_m");
    const auto to = states.texts("to"), why = states.texts("why");
    for (size_t i = 0; i < time_s.size(); ++i)
      replay.moments.push_back({time_s[i], to[i], why[i], {x[i], y[i]}});
    page.runs.push_back(std::move(run));
    addPicture(page, of_method + "/path.png", "The true path of " + method + ", coloured by its states.");
  }
  addTableDownloads(folder, page);
}

}  // namespace slam::pages
