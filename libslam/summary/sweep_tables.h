#pragma once
#include "libslam/summary/run_figures.h"
#include "libslam/sweep/sweep_plan.h"
#include "libslam/table/table.h"

namespace slam::summary {

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

}  // namespace slam::summary
