#include "libslam/summary/sweep_statistics.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/numbers.h"
#include "libslam/stats/bootstrap.h"
#include "libslam/stats/multiple_tests.h"
#include "libslam/stats/ranking.h"
#include "libslam/stats/seeds_needed.h"

namespace slam::summary {
namespace {

using core::kNaN;
/// Enough for two digits of an interval; a sweep has thousands of them.
constexpr int kResamples = 2000;

/// Values and the settings that they come from (none: all from one).
struct Sample {
  std::vector<double> values;
  std::vector<std::size_t> settings;
};

stats::BootstrapOptions bootstrap(const std::vector<std::size_t>& settings) {
  return {0.95, 1, kResamples, settings};
}

stats::Estimate medianOf(const Sample& sample) {
  if (sample.values.empty()) return {kNaN, std::nullopt};
  return stats::bootstrapMedian(sample.values, bootstrap(sample.settings));
}

/// Of one among so many comparisons: at the first step of Holm's method, which is the hardest.
std::string moreSeeds(const std::vector<double>& a, const std::vector<double>& b, std::size_t comparisons) {
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

}  // namespace

SweepStatistics::SweepStatistics(const sweep::SweepPlan& plan, const SweepResults& results)
    : plan_(plan),
      results_(results),
      keys_(summaryKeys(plan)),
      names_(methodNames(plan)),
      better_(betterOf(plan.metric)),
      baseline_(static_cast<std::size_t>(std::find(names_.begin(), names_.end(), plan.baseline) -
                                         names_.begin())) {}

std::vector<MethodStatistics> SweepStatistics::of(const SweepGroup& group) const {
  std::vector<MethodStatistics> rows;
  for (const auto& runs : group.methods) rows.push_back(alone(runs, group.settings));
  compare(group, rows);
  return rows;
}

MethodStatistics SweepStatistics::alone(const std::vector<std::size_t>& runs,
                                        const std::vector<std::size_t>& settings) const {
  MethodStatistics row;
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

void SweepStatistics::compare(const SweepGroup& group, std::vector<MethodStatistics>& rows) const {
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

}  // namespace slam::summary
