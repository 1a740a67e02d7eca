#include "libslam/summary/sweep_tables.h"

#include <algorithm>
#include <map>
#include <optional>

#include "libslam/core/numbers.h"
#include "libslam/files/parameters.h"
#include "libslam/stats/seeds_needed.h"
#include "libslam/summary/sweep_groups.h"
#include "libslam/summary/sweep_statistics.h"
#include "libslam/sweep/sweep.h"

namespace slam::summary {
namespace {

using core::kNaN;

double failureRate(const MethodStatistics& row) {
  return row.runs == 0 ? kNaN : static_cast<double>(row.failed) / static_cast<double>(row.runs);
}

double lowOf(const stats::Estimate& estimate) {
  return estimate.interval ? estimate.interval->low : kNaN;
}
double highOf(const stats::Estimate& estimate) {
  return estimate.interval ? estimate.interval->high : kNaN;
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
    failed += ", or more than " + files::formatNumber(plan.failure_ate_m) + " m off (ate_final_m),";
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
    table.notes.push_back(method + ": " + files::formatNumber(scans) +
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

table::Table resultsTable(const sweep::SweepPlan& plan, const SweepResults& results) {
  table::Table table;
  table.caption = "Sweep " + plan.name + ", one row per run";
  table.columns = {{"run", "run", 0}};
  for (const auto& axis : sweepAxes()) table.columns.push_back({axis.key, axis.key, 0});
  for (const char* key : {"seed", "method", "parameters", "status", "message"})
    table.columns.push_back({key, key, 0});
  const auto list = figureColumns();
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
    for (const auto& figure : list) row.emplace_back(results[i] ? figureOf(*results[i], figure.key) : kNaN);
    row.insert(row.end(),
               {"cells/" + run.id, log.simulated ? "cells/" + log.id : "", sweep::reproduceLine(run.id)});
    table.rows.push_back(std::move(row));
  }
  return table;
}

namespace {

using Rows = std::vector<MethodStatistics>;  ///< of one group, by method

table::Table shortSummary(const sweep::SweepPlan& plan, const SweepStatistics& summary,
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
      const MethodStatistics& of = rows_of_groups[g][m];
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

table::Table fullSummary(const SweepStatistics& summary, const std::vector<SweepGroup>& groups,
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
      const MethodStatistics& of = rows_of_groups[g][m];
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
  const SweepStatistics summary(plan, results);
  const auto groups = summary.groups();
  std::vector<Rows> rows;
  rows.reserve(groups.size());
  for (const auto& group : groups) rows.push_back(summary.of(group));
  SweepSummary tables{shortSummary(plan, summary, groups, rows), fullSummary(summary, groups, rows)};
  for (auto* table : {&tables.main, &tables.all}) {
    table->caption = "Sweep " + plan.name + ": medians over the seeds, ranked by " + plan.metric;
    addNotes(plan, results, *table);
  }
  return tables;
}

}  // namespace slam::summary
