#include "libslam/study/sweep_gate.h"

#include <algorithm>
#include <map>
#include <utility>

#include "libslam/core/numbers.h"
#include "libslam/score/metric_infos.h"
#include "libslam/summary/sweep_groups.h"

namespace slam::study {
namespace {

using core::kNaN;

std::string cellOf(const sweep::PlannedRun& run, const sweep::PlannedLog& log) {
  std::string text = summary::fullName(run) + " on " + log.world;
  const std::pair<const char*, const std::string*> others[] = {{"robot", &log.robot},
                                                               {"lidar", &log.lidar},
                                                               {"odometry", &log.odometry},
                                                               {"strategy", &log.strategy},
                                                               {"fault", &log.fault}};
  for (const auto& [axis, name] : others)
    if (*name != "built-in" && *name != "-") text += std::string(", ") + axis + " " + *name;
  return text;
}

/// Those of figureKeys() of which one direction is better.
std::vector<std::pair<std::string, stats::Better>> judgedFigures() {
  std::vector<std::pair<std::string, stats::Better>> list;
  for (const auto& key : summary::figureKeys()) {
    const auto& infos = score::metricInfos();
    const auto info =
        std::find_if(infos.begin(), infos.end(), [&](const score::MetricInfo& i) { return i.key == key; });
    if (info == infos.end())
      list.emplace_back(key, stats::Better::kSmaller);  // by relations
    else if (info->better)
      list.emplace_back(key, *info->better);
  }
  return list;
}

}  // namespace

std::vector<score::Score> scoresOf(const sweep::SweepPlan& plan, const summary::SweepResults& results) {
  std::vector<std::string> cells;  // in the order of the plan
  std::map<std::string, std::vector<std::size_t>> runs_of_cell;
  for (std::size_t i = 0; i < plan.runs.size(); ++i) {
    const std::string cell = cellOf(plan.runs[i], plan.logs[plan.runs[i].log]);
    auto& runs = runs_of_cell[cell];
    if (runs.empty()) cells.push_back(cell);
    runs.push_back(i);
  }
  std::vector<score::Score> scores;
  const auto figures = judgedFigures();
  for (const auto& cell : cells)
    for (const auto& [metric, better] : figures) {
      score::Score score{cell, metric, {}};
      for (const auto run : runs_of_cell.at(cell)) {
        const auto& result = results[run];
        score.seeds.push_back(plan.runs[run].seed);
        score.values.push_back(!result                            ? kNaN
                               : summary::isFailed(plan, *result) ? stats::failedValue(better)
                                                                  : summary::figureOf(*result, metric));
      }
      scores.push_back(std::move(score));
    }
  return scores;
}

std::vector<score::Score> summaryScoresOf(const sweep::SweepPlan& plan,
                                          const summary::SweepResults& results) {
  auto scores = scoresOf(plan, results);
  const auto keys = summary::summaryKeys(plan);
  scores.erase(std::remove_if(scores.begin(), scores.end(),
                              [&](const score::Score& score) {
                                return std::find(keys.begin(), keys.end(), score.metric) == keys.end();
                              }),
               scores.end());
  return scores;
}

}  // namespace slam::study
