#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libslam/score/evaluate.h"
#include "libslam/stats/paired.h"
#include "libslam/study/sweep_groups.h"
#include "libslam/sweep/cell.h"
#include "libslam/sweep/sweep_plan.h"
#include "libslam/table/table.h"

namespace slam::study {

/// The results of a sweep's runs, results[i] of plan.runs[i]; none where the run is missing.
using SweepResults = std::vector<std::optional<sweep::CellResult>>;

/// A run that gave no usable path: its status is not ok, or it ended farther off than the suite allows
/// (failure_ate_m).
bool isFailed(const sweep::SweepPlan& plan, const sweep::CellResult& result);
/// The figures that a run may have, in the order of the tables; none that depends on the machine.
std::vector<std::string> figureKeys();
/// The title of a figure and how many decimals people see. REQUIRES a key of figureKeys() (ContractError).
table::Column figureColumn(const std::string& key);
/// Those that the summary shows, the suite's metric first.
std::vector<std::string> summaryKeys(const sweep::SweepPlan& plan);
/// NaN where there is no such figure.
double figureOf(const sweep::CellResult& result, const std::string& key);
/// Of a suite's metric.
stats::Better betterOf(const std::string& metric);
/// The suite's metric of a run, of a failed one stats::failedValue(); NaN where it is missing or has no such
/// figure.
double rankedValue(const sweep::SweepPlan& plan, const std::optional<sweep::CellResult>& result);
/// "0.012 [0.008, 0.020]"; from 100000 on as 1.2e+05; "-" for NaN, "failed" for infinity.
std::string withInterval(const stats::Estimate& estimate, int decimals);

/// One row per run: where it stands on the axes, how it ended, every figure, its folder and how to do it
/// again. The same bytes for the same suite and code.
table::Table resultsTable(const sweep::SweepPlan& plan, const SweepResults& results);

/// Statistics over the seeds, one row per method for every combination of the other axes and, where there are
/// several, for all of them together. Of the suite's metric: the median of all runs, a failed one counting as
/// worse than any other, with its 95 % bootstrap interval; groups of methods that cannot be told apart
/// (rankingGroups()); the share of seeds on which a method beats the baseline, with interval, the p-value of
/// the paired signed-rank test against it, by Holm's method over the other methods of the group, and how many
/// more seeds would settle it (moreSeedsNeeded() at 5 % over the number of such comparisons, Holm's hardest
/// step). Of other figures the median and interval over the runs that did not fail. Failure rates with
/// Clopper and Pearson's interval. Paired figures use the seeds on which every method's run is there. The
/// rows of all settings together draw and rank within each setting (BootstrapOptions::strata,
/// wilcoxonSignedRank()), for runs in one have much in common; where each setting has a single run, settings
/// are what is drawn. The same bytes for the same results.
struct SweepSummary {
  table::Table main;  ///< without the axes that do not vary; an interval and its figure in one cell
  table::Table all;   ///< every figure in a column of its own
};
SweepSummary summarize(const sweep::SweepPlan& plan, const SweepResults& results);

/// Time and memory: differ from run to run. costs[i] is of plan.runs[i].
table::Table sweepCostTable(const sweep::SweepPlan& plan, const std::vector<sweep::CellCost>& costs);
/// The same as medians, one row per method.
table::Table sweepCostSummary(const sweep::SweepPlan& plan, const std::vector<sweep::CellCost>& costs);

}  // namespace slam::study
