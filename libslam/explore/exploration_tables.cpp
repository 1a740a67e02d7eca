#include "libslam/explore/exploration_tables.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libslam/core/numbers.h"
#include "libslam/table/number_text.h"

namespace slam::explore {
namespace {

using core::kInfinity;
using core::kNaN;

/// A figure of the tables: how it is taken from a run, and how it is shown.
struct TableFigure {
  table::Column column;
  double (*of)(const Exploration&);
  bool for_people;         ///< in the printed table too
  bool never_is_endless;   ///< NaN means "never reached": counts as infinitely late in a median
  bool of_oracle = false;  ///< in the printed table when the oracle was asked
};

const std::vector<TableFigure>& figures() {
  using E = const Exploration&;
  static const std::vector<TableFigure> all = {
      {{"coverage_percent", "explored %", 1}, [](E e) { return 100 * e.figures.coverage; }, true, false},
      {{"t90_s", "90 % s", 0}, [](E e) { return e.figures.t90_s; }, true, true},
      {{"t99_s", "99 % s", 0}, [](E e) { return e.figures.t99_s; }, true, true},
      {{"time_s", "end s", 0}, [](E e) { return e.figures.time_s; }, true, false},
      {{"path90_m", "90 % m", 1}, [](E e) { return e.figures.path90_m; }, true, true},
      {{"path99_m", "99 % m", 1}, [](E e) { return e.figures.path99_m; }, true, true},
      {{"ratio90", "90 % ratio", 2}, [](E e) { return e.ratio90; }, false, true, true},
      {{"ratio99", "99 % ratio", 2}, [](E e) { return e.ratio99; }, false, true, true},
      {{"path_m", "path m", 1}, [](E e) { return e.figures.path_m; }, true, false},
      {{"redundant_percent", "redundant %", 0},
       [](E e) { return 100 * e.figures.redundant_share; },
       true,
       false},
      {{"collisions", "collisions", 0}, [](E e) { return e.collisions; }, true, false},
      {{"near_misses", "near", 0}, [](E e) { return e.near_misses; }, true, false},
      {{"decisions", "decisions", 0}, [](E e) { return e.decisions; }, true, false},
      {{"ate_rmse_m", "ATE m", 3}, [](E e) { return e.evaluation.trajectory.position_m.rmse; }, true, false},
      {{"wall_f1", "wall F1", 3}, [](E e) { return e.evaluation.map.occupied_f1; }, true, false},
      {{"free_iou", "free IoU", 3}, [](E e) { return e.evaluation.map.free_iou; }, false, false},
      {{"wall_to_truth_p95_m", "wall 95 % m", 3},
       [](E e) { return e.evaluation.map.wall_to_truth_p95_m; },
       false,
       false},
      {{"revisits", "revisits", 0}, [](E e) { return e.revisits; }, false, false},
      {{"scans", "scans", 0}, [](E e) { return static_cast<double>(e.figures.scans); }, false, false},
      {{"scans90", "scans 90 %", 0}, [](E e) { return e.figures.scans90; }, false, true},
      {{"scans99", "scans 99 %", 0}, [](E e) { return e.figures.scans99; }, false, true},
      {{"return_distance_m", "to start m", 2}, [](E e) { return e.return_distance_m; }, false, false},
      {{"oracle90_m", "oracle 90 % m", 1}, [](E e) { return e.oracle90_m; }, false, false},
      {{"oracle99_m", "oracle 99 % m", 1}, [](E e) { return e.oracle99_m; }, false, false},
      {{"below90_m", "least 90 % m", 1}, [](E e) { return e.below90_m; }, false, false},
      {{"below99_m", "least 99 % m", 1}, [](E e) { return e.below99_m; }, false, false},
      {{"explorable_m2", "explorable m2", 1}, [](E e) { return e.explorable_m2; }, false, false},
      {{"explorable_share", "of free", 3}, [](E e) { return e.explorable_share; }, false, false}};
  return all;
}

/// Quantile over the runs that have not failed; NaN when it falls on a run that never got there.
double quantileOf(const TableFigure& figure, const StrategyRuns& runs, double share) {
  std::vector<double> values;
  for (const Exploration* e : runs) {
    if (e->end == ExplorationEnd::kFailed) continue;
    const double value = figure.of(*e);
    if (std::isnan(value) && !figure.never_is_endless) return kNaN;
    values.push_back(std::isnan(value) ? kInfinity : value);
  }
  const double result = metrics::quantile(values, share);
  return std::isfinite(result) ? result : kNaN;
}

std::string slamLabel(const std::string& slam) {
  return slam == kTruthReference ? "truth (reference)" : slam;
}

/// "finished 8, duration 2"
std::string endsOf(const StrategyRuns& runs) {
  std::map<ExplorationEnd, int> counts;
  for (const Exploration* e : runs) ++counts[e->end];
  std::string text;
  for (const auto& [end, count] : counts)
    text += (text.empty() ? "" : ", ") + endName(end) + (runs.size() == 1 ? "" : " " + std::to_string(count));
  return text;
}

double countOf(const StrategyRuns& runs, double metrics::ExplorationFigures::*reached) {
  return static_cast<double>(std::count_if(
      runs.begin(), runs.end(), [&](const Exploration* e) { return std::isfinite(e->figures.*reached); }));
}

}  // namespace

std::map<std::string, table::Best> bestFigures() {
  std::map<std::string, table::Best> best;
  for (const char* key : {"t90_s", "t99_s", "path90_m", "path99_m", "ratio90", "ratio99", "redundant_percent",
                          "collisions", "near_misses", "ate_rmse_m"})
    best[key] = table::Best::kSmallest;
  for (const char* key : {"coverage_percent", "wall_f1"}) best[key] = table::Best::kLargest;
  return best;
}

table::Table runsTable(const std::vector<Exploration>& runs, const std::string& plan_name) {
  table::Table table;
  table.columns = {{"plan", "plan"}, {"strategy", "strategy"}, {"slam", "slam"}, {"seed", "seed", 0}};
  for (const auto& figure : figures()) table.columns.push_back(figure.column);
  table.columns.push_back({"end", "end"});
  table.columns.push_back({"end_detail", "end detail"});
  for (const auto& e : runs) {
    std::vector<table::CellValue> row = {plan_name, e.strategy, slamLabel(e.slam),
                                         static_cast<double>(e.seed)};
    for (const auto& figure : figures()) row.emplace_back(figure.of(e));
    row.emplace_back(endName(e.end));
    row.emplace_back(e.end_detail);
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<StrategyRuns> byStrategy(const std::vector<Exploration>& runs, int seeds) {
  std::vector<StrategyRuns> groups;
  for (size_t i = 0; i < runs.size(); ++i) {
    if (i % static_cast<size_t>(seeds) == 0) groups.emplace_back();
    groups.back().push_back(&runs[i]);
  }
  return groups;
}

table::Table statisticsTable(const std::vector<StrategyRuns>& groups, const std::string& plan_name) {
  table::Table table;
  table.columns = {{"plan", "plan"},
                   {"strategy", "strategy"},
                   {"slam", "slam"},
                   {"runs", "runs", 0},
                   {"failed", "failed", 0},
                   {"reached90", "reached 90 %", 0},
                   {"reached99", "reached 99 %", 0}};
  for (const auto& figure : figures())
    for (const char* suffix : {"", "_q1", "_q3"})
      table.columns.push_back({figure.column.key + suffix, figure.column.key + suffix});
  table.columns.push_back({"ends", "ends"});
  for (const auto& runs : groups) {
    const auto failed = std::count_if(runs.begin(), runs.end(),
                                      [](const Exploration* e) { return e->end == ExplorationEnd::kFailed; });
    std::vector<table::CellValue> row = {plan_name,
                                         runs.front()->strategy,
                                         slamLabel(runs.front()->slam),
                                         static_cast<double>(runs.size()),
                                         static_cast<double>(failed),
                                         countOf(runs, &metrics::ExplorationFigures::t90_s),
                                         countOf(runs, &metrics::ExplorationFigures::t99_s)};
    for (const auto& figure : figures())
      for (const double share : {0.5, 0.25, 0.75}) row.emplace_back(quantileOf(figure, runs, share));
    row.emplace_back(endsOf(runs));
    table.rows.push_back(std::move(row));
  }
  return table;
}

table::Table scoresTable(const std::vector<StrategyRuns>& groups, const std::string& caption,
                         bool with_oracle) {
  const auto isShown = [&](const TableFigure& figure) {
    return figure.for_people || (figure.of_oracle && with_oracle);
  };
  table::Table table;
  table.caption = caption;
  table.columns = {{"strategy", "strategy"}};
  for (const auto& figure : figures())
    if (isShown(figure)) table.columns.push_back(figure.column);
  table.columns.push_back({"end", "end"});
  for (const auto& runs : groups) {
    std::vector<table::CellValue> row = {runs.front()->strategy}, spread = {std::string("  25 to 75 %")};
    for (const auto& figure : figures()) {
      if (!isShown(figure)) continue;
      const int decimals = figure.column.decimals;
      row.emplace_back(quantileOf(figure, runs, 0.5));
      spread.emplace_back(table::fixed(quantileOf(figure, runs, 0.25), decimals) + ".." +
                          table::fixed(quantileOf(figure, runs, 0.75), decimals));
    }
    row.emplace_back(endsOf(runs));
    spread.emplace_back(std::string());
    table.rows.push_back(std::move(row));
    if (runs.size() > 1) table.rows.push_back(std::move(spread));
  }
  return table;
}

table::Table costTable(const std::vector<Exploration>& runs) {
  table::Table table;
  table.caption = "CPU time per decision on this machine";
  table.columns = {{"strategy", "strategy"},
                   {"seed", "seed", 0},
                   {"decision_mean_ms", "mean ms", 3},
                   {"decision_max_ms", "max ms", 3}};
  for (const auto& e : runs)
    table.rows.push_back({e.strategy, static_cast<double>(e.seed), e.decision_mean_ms, e.decision_max_ms});
  return table;
}

const std::vector<std::pair<std::string, std::string>>& explorationFigureInfos() {
  static const std::vector<std::pair<std::string, std::string>> infos = {
      {"coverage_percent",
       "explored share of what can be explored: the free cells that the robot's disc can reach, or see from "
       "there"},
      {"t90_s", "robot's time until 90 % of that were explored; t99_s likewise"},
      {"path90_m", "true path until then; path99_m, scans90 and scans99 likewise"},
      {"ratio99",
       "with --oracle: path99_m over what a tour of somebody who knows the plan needs (oracle99_m); "
       "below99_m is "
       "what no path can be shorter than; ratio90 and the like likewise"},
      {"redundant_percent",
       "share of the path that adds no new area: pieces of 1 m that show less than 0.1 m2"},
      {"collisions", "commands that a wall cut short"},
      {"near_misses", "episodes with less than 0.05 m between the robot's disc and a wall"},
      {"revisits", "decisions to go back to where the pose was surer, for a loop"},
      {"return_distance_m", "true distance to the start after driving back to it"}};
  return infos;
}

core::Point2 goalInMap(const DecisionEntry& entry) {
  const auto& d = entry.decision;
  if (!d.path.empty()) return d.goal;
  return entry.T_map_robot * core::polar(d.distance_m, d.turn_rad);
}

table::Table decisionTable(const std::vector<DecisionEntry>& decisions) {
  table::Table table;
  for (const char* key : {"time_s", "map_x_m", "map_y_m", "map_yaw_rad", "goal_x_m", "goal_y_m", "score",
                          "spread_m", "certainty_m", "waypoints", "alternatives", "reason"})
    table.columns.push_back({key, key, 3});
  for (const auto& entry : decisions) {
    const auto goal = goalInMap(entry);
    const auto& decision = entry.decision;
    table.rows.push_back({entry.time_s, entry.T_map_robot.x, entry.T_map_robot.y, entry.T_map_robot.phi,
                          goal.x, goal.y, decision.score, decision.spread_m, decision.certainty_m,
                          static_cast<double>(decision.path.size()),
                          static_cast<double>(decision.alternatives.size()), decision.reason});
  }
  return table;
}

}  // namespace slam::explore
