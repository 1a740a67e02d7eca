#include "libslam/study/sweep_tables.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <map>
#include <set>

#include "libslam/core/error.h"
#include "libslam/stats/bootstrap.h"
#include "libslam/stats/multiple_tests.h"
#include "libslam/stats/paired.h"
#include "libslam/stats/proportion.h"
#include "libslam/stats/ranking.h"
#include "libslam/stats/seeds_needed.h"
#include "libslam/study/sweep_groups.h"
#include "libslam/sweep/sweep.h"

namespace slam::study {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
/// Enough for two digits of an interval; a sweep has thousands of them.
constexpr int kResamples = 2000;
constexpr double kLongest = 1e5;  // a figure with more digits is shown as a power of ten

/// The figures of a run, in the order of the tables.
std::vector<table::Column> figures() {
  std::vector<table::Column> list;
  const auto& costs = score::costKeys();
  for (const auto& info : score::metricInfos())
    if (info.key != "agreement_m" && !std::count(costs.begin(), costs.end(), info.key))
      list.push_back({info.key, info.title, info.decimals});
  list.push_back({"relation_m", "relation m", 4});
  list.push_back({"relation_deg", "relation deg", 3});
  return list;
}

std::string fixed(double value, int decimals) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return "failed";
  char text[64];
  if (std::abs(value) >= kLongest)
    std::snprintf(text, sizeof text, "%.1e", value);
  else
    std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

/// What a row of the summary says of one method in one group.
struct Row {
  std::size_t runs = 0, failed = 0;
  stats::Interval failure_rate;
  std::vector<stats::Estimate> figures;  ///< the metric first; NaN where there is none
  std::string letters = "-";
  stats::Estimate better{kNan, std::nullopt};
  double p = kNan, adjusted_p = kNan;
  std::string more_seeds;
};

class Summary {
 public:
  Summary(const sweep::SweepPlan& plan, const SweepResults& results) : plan_(plan), results_(results) {
    keys_ = summaryKeys(plan);
    better_ = betterOf(plan.metric);
    names_ = methodNames(plan);
    baseline_ =
        static_cast<std::size_t>(std::find(names_.begin(), names_.end(), plan.baseline) - names_.begin());
  }

  const std::vector<std::string>& keys() const { return keys_; }
  const std::vector<std::string>& names() const { return names_; }
  std::vector<SweepGroup> groups() const { return groupsOf(plan_, names_); }

  std::vector<Row> rows(const SweepGroup& group) const {
    std::vector<Row> rows;
    for (const auto& runs : group.methods) rows.push_back(alone(runs, group.settings));
    compare(group, rows);
    return rows;
  }

 private:
  /// Values and the settings that they come from (none: all from one).
  struct Sample {
    std::vector<double> values;
    std::vector<std::size_t> settings;
  };

  static stats::BootstrapOptions bootstrap(const std::vector<std::size_t>& settings) {
    return {0.95, 1, kResamples, settings};
  }

  static stats::Estimate medianOf(const Sample& sample) {
    if (sample.values.empty()) return {kNan, std::nullopt};
    return stats::bootstrapMedian(sample.values, bootstrap(sample.settings));
  }

  Row alone(const std::vector<std::size_t>& runs, const std::vector<std::size_t>& settings) const {
    Row row;
    std::vector<Sample> samples(keys_.size());
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const std::size_t run = runs[i];
      const auto add = [&](std::size_t key, double value) {
        samples[key].values.push_back(value);
        if (!settings.empty()) samples[key].settings.push_back(settings[i]);
      };
      if (!results_[run]) continue;
      ++row.runs;
      const bool failed = isFailed(plan_, *results_[run]);
      row.failed += failed ? 1 : 0;
      if (const double value = rankedValue(plan_, results_[run]); !std::isnan(value)) add(0, value);
      for (std::size_t k = 1; k < keys_.size() && !failed; ++k)
        if (const double value = figureOf(*results_[run], keys_[k]); std::isfinite(value)) add(k, value);
    }
    row.failure_rate = stats::clopperPearson(row.failed, row.runs);
    for (const auto& sample : samples) row.figures.push_back(medianOf(sample));
    return row;
  }

  void compare(const SweepGroup& group, std::vector<Row>& rows) const {
    std::vector<std::vector<double>> values(names_.size());
    std::vector<std::size_t> settings;
    for (std::size_t i = 0; i < group.methods.front().size(); ++i) {
      std::vector<double> of_seed;
      for (const auto& runs : group.methods) of_seed.push_back(rankedValue(plan_, results_[runs[i]]));
      if (std::any_of(of_seed.begin(), of_seed.end(), [](double v) { return std::isnan(v); })) continue;
      for (std::size_t m = 0; m < values.size(); ++m) values[m].push_back(of_seed[m]);
      if (!group.settings.empty()) settings.push_back(group.settings[i]);
    }
    if (values.front().empty()) return;
    for (const auto& ranked : stats::rankingGroups(values, better_, 0.05, settings).methods)
      rows[ranked.method].letters = ranked.letters;
    std::vector<double> p_values;
    for (std::size_t m = 0; m < values.size(); ++m) {
      if (m == baseline_) continue;
      const auto& mine = values[m];
      const auto& base = values[baseline_];
      rows[m].better = stats::probabilityOfImprovement(mine, base, better_, settings);
      rows[m].p = stats::wilcoxonSignedRank(mine, base, settings).p;
      rows[m].more_seeds = settings.empty() ? moreSeeds(mine, base, values.size() - 1) : "-";
      p_values.push_back(rows[m].p);
    }
    const auto adjusted = stats::holm(p_values);
    for (std::size_t m = 0, i = 0; m < values.size(); ++m)
      if (m != baseline_) rows[m].adjusted_p = adjusted[i++];
  }

  /// Of one among so many comparisons: at the first step of Holm's method, which is the hardest.
  static std::string moreSeeds(const std::vector<double>& a, const std::vector<double>& b,
                               std::size_t comparisons) {
    std::vector<double> differences;
    for (std::size_t i = 0; i < a.size(); ++i)
      if (std::isfinite(a[i]) && std::isfinite(b[i])) differences.push_back(a[i] - b[i]);
    if (differences.size() != a.size()) return "unknown";
    const auto needed = stats::moreSeedsNeeded(differences, 0.05 / static_cast<double>(comparisons));
    using Answer = stats::SeedsNeeded::Answer;
    if (needed.answer == Answer::kEnough) return "0";
    if (needed.answer == Answer::kMore) return std::to_string(needed.more);
    return needed.answer == Answer::kUnknown ? "unknown" : "never";
  }

  const sweep::SweepPlan& plan_;
  const SweepResults& results_;
  std::vector<std::string> keys_, names_;
  stats::Better better_;
  std::size_t baseline_ = 0;
};

double failureRate(const Row& row) {
  return row.runs == 0 ? kNan : static_cast<double>(row.failed) / static_cast<double>(row.runs);
}

double lowOf(const stats::Estimate& estimate) {
  return estimate.interval ? estimate.interval->low : kNan;
}
double highOf(const stats::Estimate& estimate) {
  return estimate.interval ? estimate.interval->high : kNan;
}

/// Says so where there are too few seeds for any difference in one setting to count. `runs_of_group`: of each
/// setting and method, the number of runs.
void addSeedNote(const sweep::SweepPlan& plan, const std::map<std::string, std::size_t>& runs_of_group,
                 table::Table& table) {
  const std::size_t comparisons = methodNames(plan).size() - 1;
  if (comparisons == 0) return;
  std::size_t most = 0;
  for (const auto& [group, runs] : runs_of_group) most = std::max(most, runs);
  const std::size_t fewest = stats::pairsNeeded(0.05 / static_cast<double>(comparisons));
  if (most < 2 || most >= fewest) return;
  table.notes.push_back(
      "With " + std::to_string(most) +
      " seeds no difference in a single setting can be told from chance: " + std::to_string(comparisons) +
      (comparisons == 1 ? " comparison at 5 % needs" : " comparisons at 5 % need") + " at least " +
      std::to_string(fewest) + ".");
}

void addNotes(const sweep::SweepPlan& plan, const SweepResults& results, table::Table& table) {
  const auto missing = std::count(results.begin(), results.end(), std::nullopt);
  if (missing > 0)
    table.notes.push_back("Incomplete: " + std::to_string(missing) + " of " + std::to_string(results.size()) +
                          " runs are missing.");
  std::string failed = "A run that ended otherwise than ok";
  if (plan.failure_ate_m > 0)
    failed += ", or more than " + core::formatNumber(plan.failure_ate_m) + " m off (ate_final_m),";
  table.notes.push_back(failed +
                        " has failed and ranks as worse than any other. In brackets 95 % intervals: "
                        "bootstrap over the runs (BCa) of medians, Clopper and Pearson's of failure rates.");
  table.notes.push_back(
      "Methods that share a letter cannot be told apart by " + plan.metric +
      " (signed-rank test on the same seeds, Holm's method, 5 %). Better: share of seeds on "
      "which the method beats " +
      plan.baseline +
      "; p: of that difference, by Holm's method. More seeds: how many more would settle it, by the "
      "differences "
      "seen so far.");
  std::map<std::string, double> skewed;  // by method
  for (std::size_t i = 0; i < results.size(); ++i)
    if (results[i])
      if (const double scans = figureOf(*results[i], "skewed_scans"); scans > 0)
        skewed[fullName(plan.runs[i])] += scans;
  for (const auto& [method, scans] : skewed)
    table.notes.push_back(method + ": " + core::formatNumber(scans) +
                          " scans were swept while the robot moved and were not deskewed.");
  std::map<std::string, std::size_t> runs_of_group;
  for (const auto& run : plan.runs) {
    ++runs_of_group[fullName(run) + '\n' + settingKey(plan.logs[run.log])];
  }
  addSeedNote(plan, runs_of_group, table);
  const bool is_single = std::any_of(runs_of_group.begin(), runs_of_group.end(),
                                     [](const auto& group) { return group.second == 1; });
  const bool is_repeated = std::any_of(runs_of_group.begin(), runs_of_group.end(),
                                       [](const auto& group) { return group.second > 1; });
  if (!varyingAxes(plan).empty() && is_repeated)
    table.notes.emplace_back(
        "All: runs in one setting (building, lidar and so on) have much in common, so intervals come from "
        "drawing within each setting, and the test ranks the differences within each (as van Elteren's "
        "does). "
        "Both speak of these settings, not of others.");
  if (is_single) table.notes.emplace_back("One run with one seed per row: small differences may be chance.");
}

}  // namespace

bool isFailed(const sweep::SweepPlan& plan, const sweep::CellResult& result) {
  if (result.status != "ok") return true;
  return plan.failure_ate_m > 0 && figureOf(result, "ate_final_m") > plan.failure_ate_m;
}

table::Column figureColumn(const std::string& key) {
  for (const auto& figure : figures())
    if (figure.key == key) return figure;
  throw core::ContractError("no figure '" + key + "'");
}

std::vector<std::string> figureKeys() {
  std::vector<std::string> keys;
  for (const auto& figure : figures()) keys.push_back(figure.key);
  return keys;
}

std::vector<std::string> summaryKeys(const sweep::SweepPlan& plan) {
  std::vector<std::string> keys = {plan.metric};
  for (const char* key : {"ate_rmse_m", "wall_f1", "free_iou"})
    if (key != plan.metric) keys.emplace_back(key);
  return keys;
}

double figureOf(const sweep::CellResult& result, const std::string& key) {
  for (const auto& [name, value] : result.figures)
    if (name == key) return value;
  return kNan;
}

stats::Better betterOf(const std::string& metric) {
  const bool larger = metric == "wall_f1" || metric == "free_iou";
  return larger ? stats::Better::kLarger : stats::Better::kSmaller;
}

double rankedValue(const sweep::SweepPlan& plan, const std::optional<sweep::CellResult>& result) {
  if (!result) return kNan;
  if (isFailed(plan, *result)) return stats::failedValue(betterOf(plan.metric));
  return figureOf(*result, plan.metric);
}

std::string withInterval(const stats::Estimate& estimate, int decimals) {
  std::string text = fixed(estimate.value, decimals);
  if (estimate.interval && !std::isnan(estimate.value))
    text += " [" + fixed(estimate.interval->low, decimals) + ", " + fixed(estimate.interval->high, decimals) +
            "]";
  return text;
}

table::Table resultsTable(const sweep::SweepPlan& plan, const SweepResults& results) {
  table::Table table;
  table.caption = "Sweep " + plan.name + ", one row per run";
  table.columns = {{"run", "run", 0}};
  for (const auto& axis : sweepAxes()) table.columns.push_back({axis.key, axis.key, 0});
  for (const char* key : {"seed", "method", "parameters", "status", "message"})
    table.columns.push_back({key, key, 0});
  const auto list = figures();
  table.columns.insert(table.columns.end(), list.begin(), list.end());
  for (const char* key : {"folder", "log_folder", "reproduce"}) table.columns.push_back({key, key, 0});
  for (std::size_t i = 0; i < plan.runs.size(); ++i) {
    const auto& run = plan.runs[i];
    const auto& log = plan.logs[run.log];
    std::vector<table::CellValue> row = {run.id};
    for (const auto& axis : sweepAxes()) row.emplace_back(log.*axis.member);
    row.insert(row.end(),
               {std::to_string(run.seed), run.method, run.parameters,
                results[i] ? results[i]->status : "missing", results[i] ? results[i]->message : ""});
    for (const auto& figure : list) row.emplace_back(results[i] ? figureOf(*results[i], figure.key) : kNan);
    row.insert(row.end(),
               {"cells/" + run.id, log.simulated ? "cells/" + log.id : "", sweep::reproduceLine(run.id)});
    table.rows.push_back(std::move(row));
  }
  return table;
}

namespace {

using Rows = std::vector<Row>;  ///< of one group, by method

table::Table shortSummary(const sweep::SweepPlan& plan, const Summary& summary,
                          const std::vector<SweepGroup>& groups, const std::vector<Rows>& rows_of_groups) {
  table::Table table;
  const auto shown_axes = varyingAxes(plan);
  for (const auto& axis : shown_axes) table.columns.push_back({axis.key, axis.key, 0});
  for (const char* key : {"method", "runs", "failed"}) table.columns.push_back({key, key, 0});
  std::vector<std::size_t> shown = {0};  // of the summary's keys
  for (std::size_t k = 1; k < summary.keys().size(); ++k)
    if (summary.keys()[k] == "wall_f1") shown.push_back(k);
  for (const auto k : shown) {
    table.columns.push_back(figureColumn(summary.keys()[k]));
  }
  for (const char* key : {"group", "better"}) table.columns.push_back({key, key, 3});
  table.columns.push_back({"p", "p", 3, true});
  table.columns.push_back({"more_seeds", "more seeds", 0});
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (std::size_t m = 0; m < rows_of_groups[g].size(); ++m) {
      const Row& of = rows_of_groups[g][m];
      auto row = axisCells(groups[g], shown_axes);
      row.emplace_back(summary.names()[m]);
      row.emplace_back(static_cast<double>(of.runs));
      row.emplace_back(withInterval({failureRate(of), of.failure_rate}, 2));
      for (const auto k : shown)
        row.emplace_back(withInterval(of.figures[k], figureColumn(summary.keys()[k]).decimals));
      row.emplace_back(of.letters);
      row.emplace_back(withInterval(of.better, 2));
      row.emplace_back(of.adjusted_p);
      row.emplace_back(of.more_seeds.empty() ? "-" : of.more_seeds);
      table.rows.push_back(std::move(row));
    }
  return table;
}

table::Table fullSummary(const Summary& summary, const std::vector<SweepGroup>& groups,
                         const std::vector<Rows>& rows_of_groups) {
  table::Table table;
  for (const auto& axis : sweepAxes()) table.columns.push_back({axis.key, axis.key, 0});
  for (const char* key :
       {"method", "runs", "failed", "failure_rate", "failure_rate_low", "failure_rate_high"})
    table.columns.push_back({key, key, 3});
  for (const auto& key : summary.keys())
    for (const char* part : {"", "_low", "_high"}) {
      const auto figure = figureColumn(key);
      table.columns.push_back({key + part, figure.title + part, figure.decimals});
    }
  for (const char* key : {"group", "better", "better_low", "better_high", "p", "p_holm", "more_seeds"})
    table.columns.push_back({key, key, 4});
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (std::size_t m = 0; m < rows_of_groups[g].size(); ++m) {
      const Row& of = rows_of_groups[g][m];
      auto row = axisCells(groups[g], sweepAxes());
      row.emplace_back(summary.names()[m]);
      row.insert(row.end(), {static_cast<double>(of.runs), static_cast<double>(of.failed), failureRate(of),
                             of.failure_rate.low, of.failure_rate.high});
      for (const auto& figure : of.figures)
        row.insert(row.end(), {figure.value, lowOf(figure), highOf(figure)});
      row.emplace_back(of.letters);
      row.insert(row.end(), {of.better.value, lowOf(of.better), highOf(of.better), of.p, of.adjusted_p});
      row.emplace_back(of.more_seeds);
      table.rows.push_back(std::move(row));
    }
  return table;
}

}  // namespace

SweepSummary summarize(const sweep::SweepPlan& plan, const SweepResults& results) {
  const Summary summary(plan, results);
  const auto groups = summary.groups();
  std::vector<Rows> rows;
  rows.reserve(groups.size());
  for (const auto& group : groups) rows.push_back(summary.rows(group));
  SweepSummary tables{shortSummary(plan, summary, groups, rows), fullSummary(summary, groups, rows)};
  for (auto* table : {&tables.main, &tables.all}) {
    table->caption = "Sweep " + plan.name + ": medians over the seeds, ranked by " + plan.metric;
    addNotes(plan, results, *table);
  }
  return tables;
}

namespace {

struct CostColumn {
  const char *key, *title;
  int decimals;
  double sweep::CellCost::*member;
};
const std::vector<CostColumn>& costColumns() {
  static const std::vector<CostColumn> list = {
      {"ms_per_scan", "ms/scan", 3, &sweep::CellCost::mean_ms_per_scan},
      {"p99_ms", "p99 ms", 3, &sweep::CellCost::p99_ms_per_scan},
      {"peak_memory_mb", "MB", 1, &sweep::CellCost::peak_memory_mb},
      {"cpu_s", "process CPU s", 2, &sweep::CellCost::cpu_s},
      {"wall_s", "by the clock s", 2, &sweep::CellCost::wall_s}};
  return list;
}

}  // namespace

table::Table sweepCostTable(const sweep::SweepPlan& plan, const std::vector<sweep::CellCost>& costs) {
  table::Table table;
  table.caption = "Time and memory of every run";
  table.columns = {{"run", "run", 0}, {"method", "method", 0}};
  for (const auto& column : costColumns())
    table.columns.push_back({column.key, column.title, column.decimals});
  for (std::size_t i = 0; i < plan.runs.size(); ++i) {
    std::vector<table::CellValue> row = {plan.runs[i].id, fullName(plan.runs[i])};
    for (const auto& column : costColumns()) row.emplace_back(costs[i].*column.member);
    table.rows.push_back(std::move(row));
  }
  return table;
}

table::Table sweepCostSummary(const sweep::SweepPlan& plan, const std::vector<sweep::CellCost>& costs) {
  table::Table table;
  table.caption = "Cost on this machine, medians over all runs";
  table.columns = {{"method", "method", 0}};
  for (const auto& column : costColumns())
    table.columns.push_back({column.key, column.title, column.decimals});
  for (const auto& name : methodNames(plan)) {
    std::vector<table::CellValue> row = {name};
    for (const auto& column : costColumns()) {
      std::vector<double> values;
      for (std::size_t i = 0; i < costs.size(); ++i)
        if (fullName(plan.runs[i]) == name && std::isfinite(costs[i].*column.member))
          values.push_back(costs[i].*column.member);
      row.emplace_back(values.empty() ? kNan : stats::median(values));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace slam::study
