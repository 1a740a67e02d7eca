#include "libslam/study/tune_statistics.h"

#include <algorithm>
#include <limits>

#include "libslam/core/error.h"
#include "libslam/files/parameters.h"
#include "libslam/stats/explained_variance.h"
#include "libslam/stats/multiple_tests.h"

namespace slam::study {
namespace {

constexpr std::size_t kFewestCandidates = 3;
constexpr double kAlpha = 0.05;

std::vector<TuneRung> rungsFrom(std::size_t candidates, std::size_t reduction) {
  std::vector<TuneRung> rungs = {{candidates, 1}};
  while (rungs.back().candidates > kFewestCandidates)
    rungs.push_back({(rungs.back().candidates + reduction - 1) / reduction, rungs.back().seeds * reduction});
  return rungs;
}

std::size_t costOf(const std::vector<TuneRung>& rungs, std::size_t logs_per_seed) {
  std::size_t runs = 0, seeds = 0;
  for (const auto& rung : rungs) {
    runs += rung.candidates * (rung.seeds - seeds) * logs_per_seed;
    seeds = rung.seeds;
  }
  return runs;
}

/// Thirds by rank of the numbers; equal numbers stay together.
std::vector<std::size_t> thirdsOf(const std::vector<double>& values) {
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::size_t> groups;
  for (const double value : values) {
    const auto rank = std::lower_bound(sorted.begin(), sorted.end(), value) - sorted.begin();
    groups.push_back(static_cast<std::size_t>(rank) * 3 / values.size());
  }
  return groups;
}

}  // namespace

HeldOutVerdict heldOutVerdict(const std::vector<std::vector<double>>& values, stats::Better better,
                              const std::vector<std::size_t>& settings) {
  if (values.size() < 2) throw core::ContractError("heldOutVerdict: no candidate beside the default");
  std::vector<double> p_values;
  for (std::size_t m = 1; m < values.size(); ++m)
    p_values.push_back(stats::wilcoxonSignedRank(values[m], values[0], settings).p);
  const auto adjusted = stats::holm(p_values);
  HeldOutVerdict chosen;
  for (std::size_t m = values.size() - 1; m > 0; --m) {
    const double share = stats::probabilityOfImprovement(values[m], values[0], better).value;
    const bool is_clear = adjusted[m - 1] <= kAlpha;
    const HeldOutVerdict verdict{m, adjusted[m - 1], share, is_clear && share > 0.5, is_clear && share < 0.5};
    // The first in training, unless only others have proven better.
    if (verdict.is_better || (m == 1 && !chosen.is_better)) chosen = verdict;
  }
  return chosen;
}

std::vector<TuneRung> tuneSchedule(std::size_t budget, std::size_t logs_per_seed, std::size_t reduction) {
  const std::size_t least = costOf(rungsFrom(kFewestCandidates, reduction), logs_per_seed);
  if (budget < least)
    throw core::InputError("--budget: found " + std::to_string(budget) + ", expected at least " +
                           std::to_string(least) + " runs");
  // More candidates can end in a longer, dearer ladder, never in a cheaper one.
  std::size_t low = kFewestCandidates, high = budget + 1;
  while (high - low > 1) {
    const std::size_t middle = low + (high - low) / 2;
    (costOf(rungsFrom(middle, reduction), logs_per_seed) <= budget ? low : high) = middle;
  }
  return rungsFrom(low, reduction);
}

std::vector<Sensitivity> sensitivities(const std::vector<std::string>& keys,
                                       const std::vector<ValueRange>& ranges,
                                       const std::vector<std::vector<std::string>>& settings,
                                       const std::vector<double>& scores) {
  constexpr std::size_t kFewest = 6;
  std::vector<Sensitivity> result;
  std::vector<double> p_values;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    Sensitivity of{keys[k], 0, 1, "-"};
    p_values.push_back(1);
    if (scores.size() >= kFewest) {
      std::vector<std::size_t> groups;
      std::vector<double> numbers;
      for (const auto& setting : settings) {
        const auto& list = ranges[k].list;
        groups.push_back(
            static_cast<std::size_t>(std::find(list.begin(), list.end(), setting[k]) - list.begin()));
        double number = 0;
        files::parseNumber(setting[k], number);
        numbers.push_back(number);
      }
      if (ranges[k].list.empty()) groups = thirdsOf(numbers);
      const auto explained = stats::explainedVariance(scores, groups);
      of.share = explained.adjusted_share;
      p_values.back() = explained.p;
      double best = std::numeric_limits<double>::infinity();
      for (const auto group : groups) {
        double sum = 0, low = std::numeric_limits<double>::infinity(), high = -low;
        int count = 0;
        for (std::size_t c = 0; c < groups.size(); ++c)
          if (groups[c] == group)
            sum += scores[c], ++count, low = std::min(low, numbers[c]), high = std::max(high, numbers[c]);
        if (sum / count >= best) continue;
        best = sum / count;
        of.best = ranges[k].list.empty() ? files::formatNumber(low) + ".." + files::formatNumber(high)
                                         : ranges[k].list[group];
      }
    }
    result.push_back(of);
  }
  const auto adjusted = stats::holm(p_values);
  for (std::size_t k = 0; k < result.size(); ++k) result[k].p = adjusted[k];
  return result;
}

}  // namespace slam::study
