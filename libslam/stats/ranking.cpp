#include "libslam/stats/ranking.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "libslam/core/error.h"
#include "libslam/stats/bootstrap.h"
#include "libslam/stats/multiple_tests.h"

namespace slam::stats {
namespace {

/// Positions in the ranking that share a letter.
using Group = std::set<std::size_t>;

std::vector<PairComparison> comparePairs(const std::vector<std::vector<double>>& values,
                                         const std::vector<std::size_t>& strata) {
  std::vector<PairComparison> pairs;
  std::vector<double> p_values;
  for (std::size_t i = 0; i < values.size(); ++i)
    for (std::size_t j = i + 1; j < values.size(); ++j) {
      p_values.push_back(wilcoxonSignedRank(values[i], values[j], strata).p);
      pairs.push_back({i, j, p_values.back(), 1});
    }
  const auto adjusted = holm(p_values);
  for (std::size_t k = 0; k < pairs.size(); ++k) pairs[k].adjusted_p = adjusted[k];
  return pairs;
}

double meanRank(const std::vector<std::vector<double>>& values, std::size_t method, Better better) {
  const double sign = better == Better::kSmaller ? 1 : -1;
  double sum = 0;
  for (std::size_t seed = 0; seed < values[method].size(); ++seed) {
    const double own = sign * values[method][seed];
    double rank = 0.5;  // its own tie with itself makes the other half
    for (const auto& other : values) {
      const double theirs = sign * other[seed];
      rank += theirs < own ? 1 : theirs == own ? 0.5 : 0;
    }
    sum += rank;
  }
  return sum / static_cast<double>(values[method].size());
}

/// Groups without those that another one holds whole.
std::vector<Group> absorbed(std::vector<Group> groups) {
  std::sort(groups.begin(), groups.end(), [](const Group& a, const Group& b) {
    return a.size() != b.size() ? a.size() > b.size() : a < b;
  });
  std::vector<Group> kept;
  for (const auto& group : groups)
    if (std::none_of(kept.begin(), kept.end(), [&](const Group& other) {
          return std::includes(other.begin(), other.end(), group.begin(), group.end());
        }))
      kept.push_back(group);
  return kept;
}

/// Of positions 0 to count - 1, given those that differ.
std::vector<Group> sharedGroups(std::size_t count,
                                const std::vector<std::pair<std::size_t, std::size_t>>& different) {
  Group everyone;
  for (std::size_t i = 0; i < count; ++i) everyone.insert(i);
  std::vector<Group> groups = {everyone};
  for (const auto& [i, j] : different) {
    std::vector<Group> split;
    for (const auto& group : groups) {
      if (group.count(i) == 0 || group.count(j) == 0) {
        split.push_back(group);
        continue;
      }
      for (const std::size_t left_out : {i, j}) {
        split.push_back(group);
        split.back().erase(left_out);
      }
    }
    groups = absorbed(std::move(split));
  }
  std::sort(groups.begin(), groups.end());  // by their best members
  return groups;
}

std::string letterOf(std::size_t group) {
  if (group < 26) return {static_cast<char>('a' + group)};
  if (group < 52) return {static_cast<char>('A' + (group - 26))};
  return "(" + std::to_string(group + 1) + ")";
}

}  // namespace

std::vector<double> meanRanks(const std::vector<std::vector<double>>& values_of_methods, Better better) {
  for (const auto& values : values_of_methods)
    if (values.empty() || values.size() != values_of_methods.front().size() ||
        std::any_of(values.begin(), values.end(), [](double v) { return std::isnan(v); }))
      throw core::ContractError("meanRanks: expected as many values for each method, at least one, none NaN");
  std::vector<double> ranks;
  for (std::size_t i = 0; i < values_of_methods.size(); ++i)
    ranks.push_back(meanRank(values_of_methods, i, better));
  return ranks;
}

std::vector<std::string> compactLetters(std::size_t count,
                                        const std::vector<std::pair<std::size_t, std::size_t>>& different) {
  for (const auto& [i, j] : different)
    if (i >= count || j >= count || i == j)
      throw core::ContractError("compactLetters: a pair is not of two things that there are");
  std::vector<std::string> letters(count);
  const auto groups = sharedGroups(count, different);
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (const std::size_t member : groups[g]) letters[member] += letterOf(g);
  return letters;
}

Ranking rankingGroups(const std::vector<std::vector<double>>& values_of_methods, Better better, double alpha,
                      const std::vector<std::size_t>& strata) {
  if (!(alpha > 0 && alpha < 1)) throw core::ContractError("rankingGroups: alpha must lie in (0, 1)");
  Ranking ranking;
  const std::size_t count = values_of_methods.size();
  if (count == 0) return ranking;
  ranking.pairs = comparePairs(values_of_methods, strata);
  for (std::size_t i = 0; i < count; ++i)
    ranking.methods.push_back({i, median(values_of_methods[i]), meanRank(values_of_methods, i, better), ""});
  const double sign = better == Better::kSmaller ? 1 : -1;
  std::stable_sort(ranking.methods.begin(), ranking.methods.end(),
                   [&](const RankedMethod& a, const RankedMethod& b) {
                     if (a.median != b.median) return sign * a.median < sign * b.median;
                     return a.mean_rank < b.mean_rank;
                   });

  std::vector<std::size_t> position(count);
  for (std::size_t i = 0; i < count; ++i) position[ranking.methods[i].method] = i;
  std::vector<std::pair<std::size_t, std::size_t>> different;
  for (const auto& pair : ranking.pairs)
    if (pair.adjusted_p <= alpha) different.emplace_back(position[pair.first], position[pair.second]);
  const auto letters = compactLetters(count, different);
  for (std::size_t i = 0; i < count; ++i) ranking.methods[i].letters = letters[i];
  return ranking;
}

}  // namespace slam::stats
