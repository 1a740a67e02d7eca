#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <tuple>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"
#include "libslam/pages/report_parts.h"
#include "libslam/score/evaluate.h"
#include "libslam/summary/run_figures.h"
#include "libslam/table/cells.h"
#include "libslam/table/number_text.h"

namespace slam::pages {
namespace fs = std::filesystem;
namespace {

const std::vector<std::string> kAxes = {"world", "robot", "lidar", "odometry", "strategy", "fault"};

/// A figure and its interval as the tables of a sweep hold them.
struct FigureWithInterval {
  double value, low, high;
};

class Rows {
 public:
  Rows(const table::Table& table, const std::string& path) : table_(table), path_(path) {}
  std::size_t count() const { return table_.rows.size(); }
  std::string text(std::size_t row, const std::string& key) const {
    return textIn(table_.rows[row][table::columnOf(table_, key, path_)]);
  }
  double number(std::size_t row, const std::string& key) const {
    return table::numberOf(table_.rows[row][table::columnOf(table_, key, path_)]);
  }
  FigureWithInterval figure(std::size_t row, const std::string& key) const {
    return {number(row, key), number(row, key + "_low"), number(row, key + "_high")};
  }

 private:
  const table::Table& table_;
  const std::string& path_;
};

/// "0.021 [0.013, 0.025]"
std::string shownFigure(const FigureWithInterval& figure, int decimals) {
  if (std::isnan(figure.value)) return "failed";
  std::string text = table::fixed(figure.value, decimals);
  const auto end = [&](double value) { return std::isfinite(value) ? table::fixed(value, decimals) : "-"; };
  if (std::isfinite(figure.low) || std::isfinite(figure.high))
    text += " [" + end(figure.low) + ", " + end(figure.high) + "]";
  return text;
}

/// The rows over all cells where there are several, else all rows.
std::vector<std::size_t> pooledRows(const Rows& rows) {
  std::vector<std::size_t> pooled, all;
  for (std::size_t i = 0; i < rows.count(); ++i) {
    all.push_back(i);
    if (std::all_of(kAxes.begin(), kAxes.end(),
                    [&](const auto& axis) { return rows.text(i, axis) == "all"; }))
      pooled.push_back(i);
  }
  return pooled.empty() ? all : pooled;
}

/// Best first by the sweep's metric; rows without a figure last.
std::vector<std::size_t> ranked(const Rows& rows, std::vector<std::size_t> which, const std::string& metric,
                                bool larger_is_better) {
  const auto worth = [&](std::size_t row) {
    const double value = rows.number(row, metric);
    if (std::isnan(value)) return HUGE_VAL;
    return larger_is_better ? -value : value;
  };
  std::stable_sort(which.begin(), which.end(), [&](auto a, auto b) { return worth(a) < worth(b); });
  return which;
}

bool shareALetter(const std::string& a, const std::string& b) {
  return a.find_first_of(b) != std::string::npos;
}

/// What the figures of all cells say, in words.
std::vector<std::string> verdictOf(const Rows& rows, const std::vector<std::size_t>& best_first,
                                   const sweep::SweepPlan& plan) {
  std::vector<std::string> verdict;
  if (std::none_of(best_first.begin(), best_first.end(),
                   [&](std::size_t row) { return rows.number(row, "runs") > 0; }))
    return {"No run has ended."};
  const auto name = [&](std::size_t row) { return rows.text(row, "method"); };
  const auto best = best_first.front();
  if (std::isnan(rows.number(best, plan.metric))) return {"No method has a figure: every run failed."};
  std::vector<std::string> equal, worse;
  for (const auto row : best_first) {
    if (row == best) continue;
    (shareALetter(rows.text(row, "group"), rows.text(best, "group")) ? equal : worse).push_back(name(row));
  }
  const auto list = [](const std::vector<std::string>& names) {
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i)
      text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
    return text;
  };
  std::string text = name(best) + " is best by " + plan.metric + ": median " +
                     shownFigure(rows.figure(best, plan.metric), 3) + ".";
  if (!equal.empty()) text += " " + list(equal) + " cannot be told apart from it with these seeds.";
  if (!worse.empty()) text += " Proven worse: " + list(worse) + ".";
  verdict.push_back(text);
  std::string failures;
  for (const auto row : best_first)
    if (const double failed = rows.number(row, "failed"); failed > 0)
      failures += (failures.empty() ? "" : ", ") + name(row) + " in " + table::fixed(failed, 0) + " of " +
                  table::fixed(rows.number(row, "runs"), 0) + " runs";
  verdict.push_back(failures.empty() ? "No run failed." : "Failed: " + failures + ".");
  return verdict;
}

/// One dot per method with its interval, best first.
table::Table rankedTable(const Rows& rows, const std::vector<std::size_t>& best_first,
                         const sweep::SweepPlan& plan) {
  table::Table table;
  table.caption = "Methods by " + plan.metric + ", over all cells, with 95 % intervals";
  table.columns = {{"method", "method"},
                   {"rank", "rank", 0},
                   {plan.metric, "median " + plan.metric},
                   {"failed", "share failed"},
                   {"group", "group"}};
  for (std::size_t i = 0; i < best_first.size(); ++i) {
    const auto row = best_first[i];
    table.rows.push_back({rows.text(row, "method"), static_cast<double>(i + 1),
                          shownFigure(rows.figure(row, plan.metric), 3),
                          shownFigure(rows.figure(row, "failure_rate"), 2), rows.text(row, "group")});
  }
  table.notes.emplace_back("Methods that share a letter cannot be told apart with these seeds.");
  return table;
}

/// Where and why runs failed; nothing where none did.
void addFailures(const std::string& folder, report::ReportPage& page) {
  const std::string path = folder + "/failures.json";
  if (!fs::exists(path)) return;
  auto all = readJsonTable(path);
  if (all.rows.empty()) return;
  table::Table table{all.caption, {}, {}, all.notes};
  std::vector<std::size_t> kept;
  for (const auto& [key, title, decimals] :
       std::vector<std::tuple<std::string, std::string, int>>{{"method", "method", 0},
                                                              {"world", "world", 0},
                                                              {"lidar", "lidar", 0},
                                                              {"fault", "fault", 0},
                                                              {"seed", "seed", 0},
                                                              {"status", "status", 0},
                                                              {"ate_final_m", "ATE (m)", 2},
                                                              {"divergence", "divergence", 0},
                                                              {"time_s", "after (s)", 1},
                                                              {"suspect", "suspect", 0},
                                                              {"run", "run", 0}}) {
    kept.push_back(table::columnOf(all, key, path));
    table.columns.push_back({key, title, decimals});
  }
  for (auto& row : all.rows) {
    table.rows.emplace_back();
    for (const auto i : kept) table.rows.back().push_back(std::move(row[i]));
  }
  page.tables.push_back(std::move(table));
}

/// The methods of a stress test as the rows first name them.
std::vector<std::string> methodsIn(const Rows& rows) {
  std::vector<std::string> methods;
  for (std::size_t i = 0; i < rows.count(); ++i)
    if (const auto method = rows.text(i, "method");
        std::find(methods.begin(), methods.end(), method) == methods.end())
      methods.push_back(method);
  return methods;
}

/// Where each method breaks, as the notes say it; these notes head the page.
std::map<std::string, std::string> breakTexts(const std::vector<std::string>& notes,
                                              const std::vector<std::string>& methods,
                                              report::ReportPage& page) {
  std::map<std::string, std::string> texts;
  std::vector<std::string> verdict;
  for (const auto& note : notes)
    for (const auto& method : methods)
      if (note.rfind(method + ": ", 0) == 0) {
        verdict.push_back(note);
        texts[method] = note.substr(method.size() + 2);
      }
  page.verdict.insert(page.verdict.begin(), verdict.begin(), verdict.end());
  return texts;
}

/// Of one figure, a curve per method.
void addCurves(const Rows& rows, const std::string& key, const std::vector<std::string>& methods,
               const std::map<std::string, std::string>& break_texts, report::PageChart& chart) {
  for (const auto& method : methods) {
    report::PageCurve curve;
    curve.label = method;
    if (const auto text = break_texts.find(method); text != break_texts.end()) curve.note = text->second;
    for (std::size_t i = 0; i < rows.count(); ++i) {
      if (rows.text(i, "method") != method) continue;
      const FigureWithInterval figure = rows.figure(i, key);
      curve.points.push_back({rows.number(i, "value"), figure.value});
      curve.low.push_back(figure.low);
      curve.high.push_back(figure.high);
      curve.broken.push_back(rows.text(i, "broken") == "yes");
    }
    chart.curves.push_back(std::move(curve));
  }
}

/// How far a stress test got: curves with intervals, and where each method breaks.
void fillStress(const std::string& folder, report::ReportPage& page) {
  const std::string path = folder + "/stress.json";
  const auto table = readJsonTable(path);
  const Rows rows(table, path);
  constexpr std::size_t kMetricColumn = 8;  // after the failure rate and its interval
  table::columnOf(table, "failure_rate_high", path);
  if (table.columns.size() <= kMetricColumn || rows.count() == 0)
    throw core::InputError(path + ": holds no figures, expected the table of a stress test");
  const std::string metric = table.columns[kMetricColumn].key;
  const std::string key = rows.text(0, "key");
  page.tables.push_back(readMarkdownTable(folder + "/stress.md"));
  const auto methods = methodsIn(rows);
  const auto break_texts = breakTexts(table.notes, methods, page);

  report::PageChart errors{"stress-error",
                           "Median " + metric +
                               " with 95 % intervals; a cross where the method is broken. Where half "
                               "of the runs failed there is no median.",
                           key,
                           "median " + metric,
                           {},
                           0,
                           0};
  report::PageChart failures{"stress-failures",
                             "Share of failed runs with 95 % intervals; a cross where the method is broken.",
                             key,
                             "failed runs (share)",
                             {},
                             1,
                             0};
  addCurves(rows, metric, methods, break_texts, errors);
  addCurves(rows, "failure_rate", methods, break_texts, failures);
  page.charts.push_back(std::move(errors));
  page.charts.push_back(std::move(failures));
  for (const char* name : {"stress.csv", "stress.tex"})
    addDownload(page, folder + "/" + name, name, "the curves",
                name == std::string("stress.tex") ? "application/x-tex" : "text/csv");
}

/// "graph 2, icp 1": how many runs of each method are not there; "" where all are.
std::string missingRuns(const Rows& results) {
  std::map<std::string, int> counts;
  for (std::size_t i = 0; i < results.count(); ++i)
    if (results.text(i, "status") == "missing") ++counts[results.text(i, "method")];
  std::string text;
  for (const auto& [method, count] : counts)
    text += (text.empty() ? "" : ", ") + method + " " + std::to_string(count);
  return text;
}

/// Maps and replay of the worst run of every method.
void addWorstRuns(const std::string& folder, const Rows& rows, const std::vector<std::string>& methods,
                  const sweep::SweepPlan& plan, core::Progress& progress, report::ReportPage& page) {
  const bool larger_is_better = summary::betterOf(plan.metric) == stats::Better::kLarger;
  const auto worth = [&](std::size_t row) {
    const double value = rows.number(row, plan.metric);
    if (std::isnan(value)) return HUGE_VAL;
    return larger_is_better ? -value : value;
  };
  std::map<std::string, std::size_t> worst;
  std::size_t there = 0, ended = 0;
  const auto runOf = [&](std::size_t row) { return folder + "/" + rows.text(row, "folder") + "/run"; };
  for (std::size_t i = 0; i < rows.count(); ++i) {
    ended += rows.text(i, "status") == "missing" ? 0 : 1;
    if (!fs::exists(runOf(i) + "/manifest.json")) continue;
    ++there;
    auto name = rows.text(i, "method");
    if (const auto parameters = rows.text(i, "parameters"); !parameters.empty()) name += " " + parameters;
    const auto [it, is_new] = worst.emplace(name, i);
    if (!is_new && worth(i) > worth(it->second)) it->second = i;
  }
  const std::size_t shown = std::min(worst.size(), kMostReplays);
  if (shown == 0) {
    if (ended > 0) page.missing.emplace_back("The runs' folders hold no paths: no maps and no replay.");
    return;
  }
  for (const auto& name : methods) {
    const auto it = worst.find(name);
    if (it == worst.end()) continue;
    if (page.replays.size() == shown) break;
    const auto row = it->second;
    page.replays.emplace_back();
    std::string where = rows.text(row, "world");
    for (const auto& axis : {"lidar", "fault"})
      if (const auto value = rows.text(row, axis); value != "built-in" && value != "-") where += ", " + value;
    where += ", seed " + rows.text(row, "seed");
    page.replays.back().name = name + " in " + where;
    const std::string log_folder = rows.text(row, "log_folder");
    std::string log_path = folder + "/" + log_folder + "/run.rawlog";
    if (log_folder.empty())  // a log that existed already
      log_path = results::logInput(resources::readManifest(runOf(row) + "/manifest.json"));
    addRun(runOf(row), log_path, name, page.replays.size() - 1, page);
    page.runs.back().summary = "Its worst run: " + where + ". " + page.runs.back().summary;
    if (fs::exists(log_path))
      readReplay(log_path, report::kMostReplayed / shown, progress, page.replays.back());
  }
  page.subtitle = "Maps and replay are those of the worst run of each method.";
  if (shown < there)
    page.left_out.push_back("To keep this page small it has maps and replay of " + std::to_string(shown) +
                            " of " + std::to_string(there) +
                            " runs only, the worst of each method; 'rasterslam report " + folder +
                            "/cells/RUN/run' shows any other.");
}

}  // namespace

bool isSweep(const std::string& folder) {
  if (!fs::exists(folder + "/plan.json")) return false;
  if (!fs::exists(folder + "/summary.json"))
    throw core::InputError(folder +
                           ": is a sweep without tables, expected summary.json: 'rasterslam bench merge " +
                           folder + " -o " + folder + "' makes them of what has ended");
  return true;
}

void fillSweep(const std::string& folder, const resources::Manifest& manifest, core::Progress& progress,
               report::ReportPage& page) {
  const bool is_stress = fs::exists(folder + "/stress.json");
  const auto plan = sweep::readSweepPlan(folder + "/plan.json");
  const std::string summary_path = folder + "/summary.json";
  const auto summary = readJsonTable(summary_path);
  const Rows rows(summary, summary_path);
  const std::string results_path = folder + "/results.json";
  const auto results = readJsonTable(results_path);
  const Rows result_rows(results, results_path);
  const bool larger = summary::betterOf(plan.metric) == stats::Better::kLarger;
  const bool is_contest = fs::exists(folder + "/standings.json");
  page.title = pageTitle(folder, is_stress ? "Stress test" : is_contest ? "Contest" : "Sweep");
  const auto best_first = ranked(rows, pooledRows(rows), plan.metric, larger);
  page.verdict = verdictOf(rows, best_first, plan);
  const auto runs = resultOf(manifest, "runs"), missing = resultOf(manifest, "missing");
  page.verdict.push_back(runs + " runs were planned" +
                         (missing.empty() || missing == "0" ? ", and all of them have ended." : "."));
  if (!missing.empty() && missing != "0") {
    const auto of_runs = missingRuns(result_rows);
    page.missing.push_back("This sweep is not finished: of its logs and runs " + missing + " are missing" +
                           (of_runs.empty() ? "" : " (runs: " + of_runs + ")") +
                           ", and no figure counts them. 'rasterslam " + (is_stress ? "stress" : "bench") +
                           " ... --resume' goes on with it.");
  }
  if (is_stress)
    fillStress(folder, page);
  else if (is_contest)
    page.tables.push_back(readMarkdownTable(folder + "/standings.md"));
  else
    page.tables.push_back(rankedTable(rows, best_first, plan));
  page.tables.push_back(readMarkdownTable(folder + "/summary.md"));
  if (const auto path = folder + "/consistency.md"; fs::exists(path))  // sweeps of older versions have none
    if (auto table = readMarkdownTable(path); !table.rows.empty()) page.tables.push_back(std::move(table));
  addFailures(folder, page);
  std::vector<std::string> methods;
  for (const auto row : best_first)
    if (const auto name = rows.text(row, "method");
        std::find(methods.begin(), methods.end(), name) == methods.end())
      methods.push_back(name);
  addWorstRuns(folder, result_rows, methods, plan, progress, page);
  for (const char* name : {"standings.csv", "summary.csv", "summary.tex", "results.csv", "consistency.csv",
                           "failures.csv", "cost.csv"})
    addDownload(page, folder + "/" + name, name, "",
                name == std::string("summary.tex") ? "application/x-tex" : "text/csv");
}

}  // namespace slam::pages
