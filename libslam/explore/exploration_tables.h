#pragma once
#include <map>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/explore/explore.h"
#include "libslam/strategies/strategy.h"
#include "libslam/table/latex.h"

namespace slam::explore {

/// A decision when it was taken.
struct DecisionEntry {
  double time_s;
  core::Pose2 T_map_robot, T_world_robot;
  choices::Decision decision;
};
/// Where it leads, map frame.
core::Point2 goalInMap(const DecisionEntry& entry);

/// Runs of one strategy, with other seeds.
using StrategyRuns = std::vector<const Exploration*>;
/// In the order of the request: strategies, seeds within.
std::vector<StrategyRuns> byStrategy(const std::vector<Exploration>& runs, int seeds);

/// Every figure of every run, for programs.
table::Table runsTable(const std::vector<Exploration>& runs, const std::string& plan_name);
/// For programs: median and quartiles as columns of their own. A run that has failed does not count; one that
/// never came to a share of the area counts as endlessly late, and a quantile that falls on such a run is
/// NaN.
table::Table statisticsTable(const std::vector<StrategyRuns>& groups, const std::string& plan_name);
/// For people: a row per strategy, with several seeds a second one with the quartiles.
table::Table scoresTable(const std::vector<StrategyRuns>& groups, const std::string& caption,
                         bool with_oracle);
table::Table costTable(const std::vector<Exploration>& runs);

/// A row for each decision.
table::Table decisionTable(const std::vector<DecisionEntry>& decisions);

/// Which end of a figure is good, by its key, for those where one is.
std::map<std::string, table::Best> bestFigures();

}  // namespace slam::explore
