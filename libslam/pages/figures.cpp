#include "libslam/pages/figures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>
#include <set>

#include "libslam/core/error.h"
#include "libslam/draw/axis_title.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"
#include "libslam/table/cells.h"

namespace slam::pages {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMostPanels = 8, kMostCharts = 24;

/// May be empty.
core::Trajectory truthOf(const report::ReportPage& page, const report::ReportRun& run) {
  return run.replay < page.replays.size() ? page.replays[run.replay].truth : core::Trajectory();
}

double rms(const std::vector<double>& values) {
  double sum = 0;
  std::size_t count = 0;
  for (const double value : values)
    if (std::isfinite(value)) sum += value * value, ++count;
  return count == 0 ? std::nan("") : std::sqrt(sum / static_cast<double>(count));
}

}  // namespace

std::vector<pictures::Panel> mapPanels(const report::ReportPage& page, const std::string& folder) {
  std::vector<pictures::Panel> panels;
  for (const auto& run : page.runs) {
    if (!run.map || panels.size() == kMostPanels) continue;
    pictures::Panel panel;
    panel.title = run.method;
    const double error_m = rms(run.error_m);
    if (std::isfinite(error_m)) {
      char text[64];
      std::snprintf(text, sizeof text, "final ATE %.3f m", error_m);
      panel.subtitle = text;
    }
    panel.map = *run.map;
    panel.T_world_map = run.T_world_map;
    panel.paths.push_back({run.path, run.method});
    if (const auto truth = truthOf(page, run); !truth.empty())
      panel.paths.push_back({truth, "true path", true});
    panels.push_back(std::move(panel));
  }
  if (panels.empty()) throw core::InputError(folder + ": holds no map, expected a run that has one");
  return panels;
}

std::vector<pictures::DrawnPath> allPaths(const report::ReportPage& page) {
  std::vector<pictures::DrawnPath> paths;
  for (const auto& run : page.runs)
    if (!run.path.empty()) paths.push_back({run.path, run.method});
  for (const auto& replay : page.replays)
    if (!replay.truth.empty()) paths.push_back({replay.truth, "true path", true});
  return paths;
}

std::vector<pictures::Panel> pathPanels(const report::ReportPage& page) {
  std::vector<pictures::Panel> panels;
  for (const auto& run : page.runs) {
    if (run.path.empty()) continue;
    pictures::Panel panel{run.method, "", {}, {}, {{run.path, run.method}}, true};
    if (run.replay < page.replays.size()) panel.map = page.replays[run.replay].plan.value_or(world::Plan{});
    if (const auto truth = truthOf(page, run); !truth.empty())
      panel.paths.push_back({truth, "true path", true});
    panels.push_back(std::move(panel));
  }
  return panels;
}

namespace {

constexpr double kSmoothedPerChart = 50;  // windows over the time that a chart shows

/// Root mean square over a window about each moment: of errors that change from scan to scan a chart would
/// show a band.
std::vector<core::Point2> smoothedErrors(const report::ReportRun& run, double window_s) {
  std::vector<core::Point2> points;
  double sum = 0;
  std::size_t from = 0, to = 0, count = 0;
  const auto change = [&](std::size_t i, int sign) {
    if (!std::isfinite(run.error_m[i])) return;
    sum += sign * run.error_m[i] * run.error_m[i];
    count += static_cast<std::size_t>(sign);
  };
  for (const auto& pose : run.path) {
    while (to < run.path.size() && run.path[to].time_s <= pose.time_s + window_s / 2) change(to++, 1);
    while (run.path[from].time_s < pose.time_s - window_s / 2) change(from++, -1);
    points.push_back(
        {pose.time_s - run.path.front().time_s,
         count == 0 ? std::nan("") : std::sqrt(std::max(0.0, sum / static_cast<double>(count)))});
  }
  return points;
}

}  // namespace

draw::Chart errorChart(const report::ReportPage& page, const std::string& folder, bool is_log) {
  draw::Chart chart{"time since the first scan (s)", "position error (m)", {}};
  chart.y_log = is_log;
  double longest_s = 0;
  std::vector<const report::ReportRun*> runs;
  for (const auto& run : page.runs) {
    if (std::isnan(rms(run.error_m))) continue;
    runs.push_back(&run);
    longest_s = std::max(longest_s, run.path.back().time_s - run.path.front().time_s);
  }
  // The best is drawn last: it is the one that others would hide.
  std::stable_sort(runs.begin(), runs.end(),
                   [](const auto* a, const auto* b) { return rms(a->error_m) > rms(b->error_m); });
  const double window_s = std::max(1.0, std::round(longest_s / kSmoothedPerChart));
  for (const auto* run : runs) chart.curves.push_back({run->method, smoothedErrors(*run, window_s)});
  chart.y_title = "position error (m), rms over " + files::formatNumber(window_s) + " s";
  if (chart.curves.empty())
    throw core::InputError(folder + ": has no errors to draw, expected a run whose true path is known");
  return chart;
}

namespace {

/// Rows that a selection takes, and how their charts and boxes are named.
class SeedRows {
 public:
  SeedRows(const table::Table& results, const SeedSelection& selection, const std::string& path)
      : metric_(table::columnOf(results, selection.metric, path)),
        method_(table::columnOf(results, "method", path)),
        status_(table::columnOf(results, "status", path)) {
    for (const auto& column : results.columns)
      if (column.key == "parameters") parameters_ = table::columnOf(results, "parameters", path);
    std::vector<std::pair<std::size_t, std::string>> conditions;
    for (const auto& condition : selection.where) {
      const auto equals = condition.find('=');
      if (equals == std::string::npos)
        throw core::InputError("--where: found '" + condition +
                               "', expected KEY=VALUE, such as world=office_loop");
      conditions.emplace_back(table::columnOf(results, condition.substr(0, equals), path),
                              condition.substr(equals + 1));
    }
    for (const auto& row : results.rows) {
      const bool is_chosen = std::all_of(conditions.begin(), conditions.end(), [&](const auto& c) {
        return table::textOf(row[c.first]) == c.second;
      });
      const auto& methods = selection.methods;
      const auto name = table::textOf(row[method_]);
      if (is_chosen && (methods.empty() || std::count(methods.begin(), methods.end(), name) > 0))
        rows_.push_back(&row);
    }
    if (rows_.empty())
      throw core::InputError(path + ": none of its " + std::to_string(results.rows.size()) +
                             " runs was chosen, expected at least one (--where, --methods)");
    for (std::size_t i = 0; i < results.columns.size(); ++i) {
      static const std::set<std::string> axes = {"world", "robot", "lidar", "odometry", "strategy", "fault"};
      std::set<std::string> values;
      for (const auto* row : rows_) values.insert(table::textOf((*row)[i]));
      if (values.size() > 1 && axes.count(results.columns[i].key) > 0) varying_.push_back(i);
    }
  }

  std::vector<draw::BoxChart> charts() const {
    std::vector<draw::BoxChart> charts;
    std::vector<std::string> methods;
    for (const auto* row : rows_)
      if (const auto name = labelOf(*row); std::find(methods.begin(), methods.end(), name) == methods.end())
        methods.push_back(name);
    std::map<std::string, std::size_t> places;
    for (const auto* row : rows_) {
      const auto [place, is_new] = places.emplace(titleOf(*row), charts.size());
      if (is_new) {
        charts.push_back({titleOf(*row), {}});
        for (const auto& method : methods) charts.back().samples.push_back({method, {}, 0});
      }
      const auto method = std::find(methods.begin(), methods.end(), labelOf(*row)) - methods.begin();
      auto& sample = charts[place->second].samples[static_cast<std::size_t>(method)];
      if (table::textOf((*row)[status_]) == "ok")
        sample.values.push_back(table::numberOf((*row)[metric_]));
      else
        ++sample.failed;
    }
    return charts;
  }

 private:
  using Row = std::vector<table::CellValue>;
  std::string labelOf(const Row& row) const {
    std::string label = table::textOf(row[method_]);
    if (parameters_ && !table::textOf(row[*parameters_]).empty())
      label += " " + table::textOf(row[*parameters_]);
    return label;
  }
  std::string titleOf(const Row& row) const {
    std::string title;
    for (const auto column : varying_) title += (title.empty() ? "" : ", ") + table::textOf(row[column]);
    return title;
  }

  std::size_t metric_, method_, status_;
  std::optional<std::size_t> parameters_;
  std::vector<const Row*> rows_;
  std::vector<std::size_t> varying_;
};

}  // namespace

std::vector<draw::BoxChart> seedBoxes(const table::Table& results, const SeedSelection& selection,
                                      const std::string& path) {
  auto charts = SeedRows(results, selection, path).charts();
  if (charts.size() > kMostCharts)
    throw core::InputError(path + ": has " + std::to_string(charts.size()) +
                           " combinations of its axes, expected at most " + std::to_string(kMostCharts) +
                           "; choose with --where, such as --where world=" +
                           charts.front().title.substr(0, charts.front().title.find(',')));
  return charts;
}

namespace {

/// One exploration: its curve stands in the rows [first, last) of a file's table.
struct ExplorationRun {
  std::string folder, strategy, file;
  std::size_t first = 0, last = 0;  // 0, 0: all
};

/// Those of a folder with tables only, whose curves stand one below the other.
std::vector<ExplorationRun> runsInOneTable(const std::string& folder, const std::string& file) {
  const auto table = table::fromCsv(files::readTextFile(file), file);
  const auto strategy = table::columnOf(table, "strategy", file), seed = table::columnOf(table, "seed", file);
  std::vector<ExplorationRun> runs;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const auto& row = table.rows[i];
    const bool is_new = i == 0 ||
                        table::textOf(row[strategy]) != table::textOf(table.rows[i - 1][strategy]) ||
                        table::textOf(row[seed]) != table::textOf(table.rows[i - 1][seed]);
    if (is_new) runs.push_back({folder, table::textOf(row[strategy]), file, i, i});
    runs.back().last = i + 1;
  }
  return runs;
}

}  // namespace

std::vector<draw::Chart> explorationCharts(const std::vector<std::string>& folders) {
  using Run = ExplorationRun;
  std::vector<Run> runs;
  for (const auto& folder : folders) {
    if (!fs::is_directory(folder))
      throw core::InputError(folder + ": is not a folder, expected one that 'rasterslam explore' wrote");
    std::vector<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      if (entry.path().filename() == "exploration.csv") files.push_back(entry.path().string());
    std::sort(files.begin(), files.end());
    if (const std::string file = folder + "/curves.csv"; files.empty() && fs::exists(file))
      for (auto& run : runsInOneTable(folder, file)) runs.push_back(std::move(run));
    else if (files.empty())
      throw core::InputError(folder +
                             ": holds no exploration.csv, expected a folder that 'rasterslam explore' wrote");
    for (const auto& file : files) {
      const auto inside = fs::relative(fs::path(file).parent_path(), folder);
      std::string strategy = inside.begin()->string();
      if (strategy == ".") {  // a single run
        const std::string list = folder + "/runs.csv";
        const auto table = table::fromCsv(files::readTextFile(list), list);
        if (table.rows.empty()) throw core::InputError(list + ": holds no run, expected one");
        strategy = table::textOf(table.rows.front()[table::columnOf(table, "strategy", list)]);
      }
      runs.push_back({folder, strategy, file, 0, 0});
    }
  }
  std::vector<draw::Chart> charts = {{"time (s)", "explored (%)", {}, 100},
                                     {"path (m)", "explored (%)", {}, 100}};
  for (const auto& run : runs) {
    const bool is_elsewhere = std::any_of(runs.begin(), runs.end(), [&](const Run& other) {
      return other.strategy == run.strategy && other.folder != run.folder;
    });
    const auto name = fs::path(run.folder).lexically_normal();
    const std::string label =
        is_elsewhere ? (name.has_filename() ? name.filename() : name.parent_path().filename()).string() +
                           ", " + run.strategy
                     : run.strategy;
    const auto table = table::fromCsv(files::readTextFile(run.file), run.file);
    const auto share = table::columnOf(table, "explored_share", run.file);
    const char* keys[] = {"time_s", "path_m"};
    for (std::size_t i = 0; i < charts.size(); ++i) {
      const auto x = table::columnOf(table, keys[i], run.file);
      draw::Curve curve{label, {}};
      const std::size_t last = run.last == 0 ? table.rows.size() : run.last;
      for (std::size_t r = run.first; r < last; ++r)
        curve.points.push_back(
            {table::numberOf(table.rows[r][x]), 100 * table::numberOf(table.rows[r][share])});
      charts[i].curves.push_back(std::move(curve));
    }
  }
  return charts;
}

}  // namespace slam::pages
