#include "libslam/stats/paired.h"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <map>
#include <numeric>
#include <string>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/stats/mean_interval.h"
#include "libslam/stats/proportion.h"

namespace slam::stats {
namespace {

constexpr std::size_t kMostExactPairs = 50;  // below 2^53 every count of sign patterns is a whole double

void checkValues(const std::vector<double>& values) {
  if (values.empty()) throw core::ContractError("a comparison of no values");
  if (std::any_of(values.begin(), values.end(), [](double value) { return std::isnan(value); }))
    throw core::ContractError("a comparison with a value that is not a number");
}

void checkPairs(const std::vector<double>& a, const std::vector<double>& b) {
  checkValues(a);
  checkValues(b);
  if (a.size() != b.size())
    throw core::ContractError("a paired comparison of " + std::to_string(a.size()) + " with " +
                              std::to_string(b.size()) + " values");
}

std::vector<double> differences(const std::vector<double>& a, const std::vector<double>& b) {
  checkPairs(a, b);
  std::vector<double> result;
  result.reserve(a.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    result.push_back(a[i] == b[i] ? 0 : a[i] - b[i]);  // two failures: not infinity minus infinity
  return result;
}

/// Twice the rank of each magnitude, counted from 1: whole numbers, since equal ones share the mean of their
/// ranks.
std::vector<std::size_t> doubledRanks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size()), ranks(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t i, std::size_t j) { return std::abs(values[i]) < std::abs(values[j]); });
  for (std::size_t first = 0; first < order.size();) {
    std::size_t next = first;
    while (next < order.size() && std::abs(values[order[next]]) == std::abs(values[order[first]])) ++next;
    for (std::size_t i = first; i < next; ++i) ranks[order[i]] = first + next + 1;
    first = next;
  }
  return ranks;
}

/// The same, each stratum by itself.
std::vector<std::size_t> doubledRanks(const std::vector<double>& values,
                                      const std::vector<std::size_t>& strata) {
  if (strata.empty()) return doubledRanks(values);
  if (strata.size() != values.size())
    throw core::ContractError("a paired comparison with strata for " + std::to_string(strata.size()) +
                              " of " + std::to_string(values.size()) + " pairs");
  std::map<std::size_t, std::vector<std::size_t>> by_number;
  for (std::size_t i = 0; i < values.size(); ++i) by_number[strata[i]].push_back(i);
  std::vector<std::size_t> ranks(values.size());
  for (const auto& [number, pairs] : by_number) {
    std::vector<double> own;
    for (const std::size_t i : pairs) own.push_back(values[i]);
    const auto own_ranks = doubledRanks(own);
    for (std::size_t k = 0; k < pairs.size(); ++k) ranks[pairs[k]] = own_ranks[k];
  }
  return ranks;
}

/// Of all sign patterns, the share whose sum of ranks is at most `sum`.
double shareUpTo(const std::vector<std::size_t>& ranks, std::size_t sum) {
  const std::size_t total = std::accumulate(ranks.begin(), ranks.end(), std::size_t{0});
  std::vector<double> patterns(total + 1);
  patterns[0] = 1;
  for (const std::size_t rank : ranks)
    for (std::size_t s = total; s >= rank; --s) patterns[s] += patterns[s - rank];
  return std::accumulate(patterns.begin(), patterns.begin() + static_cast<std::ptrdiff_t>(sum) + 1, 0.0) /
         core::exp2(static_cast<double>(ranks.size()));
}

double twoSided(double smaller_tail) {
  return std::min(1.0, 2 * smaller_tail);
}

/// 1 where a is better, 0 where b is, 1/2 where they are equal.
double preference(double a, double b, Better better) {
  if (a == b) return 0.5;
  return (a < b) == (better == Better::kSmaller) ? 1 : 0;
}

}  // namespace

double failedValue(Better better) {
  using core::kInfinity;
  return better == Better::kSmaller ? kInfinity : -kInfinity;
}

PairedTest wilcoxonSignedRank(const std::vector<double>& a, const std::vector<double>& b,
                              const std::vector<std::size_t>& strata) {
  const auto difference = differences(a, b);
  const auto all_ranks = doubledRanks(difference, strata);
  PairedTest test;
  std::vector<std::size_t> ranks;
  std::size_t above = 0, total = 0;
  double squares = 0;
  for (std::size_t i = 0; i < difference.size(); ++i) {
    if (difference[i] == 0) continue;
    ranks.push_back(all_ranks[i]);
    total += all_ranks[i];
    squares += static_cast<double>(all_ranks[i]) * static_cast<double>(all_ranks[i]);
    if (difference[i] > 0) above += all_ranks[i];
  }
  test.pairs = ranks.size();
  test.ties = difference.size() - ranks.size();
  test.statistic = static_cast<double>(above) / 2;
  test.is_exact = test.pairs <= kMostExactPairs;
  if (ranks.empty()) return test;
  const std::size_t smaller = std::min(above, total - above);  // the distribution is symmetric
  if (test.is_exact) {
    test.p = twoSided(shareUpTo(ranks, smaller));
    return test;
  }
  // In doubled ranks the mean is total / 2, the variance the sum of squares / 4, and the correction of 1/2 is
  // 1.
  const double off = static_cast<double>(total) / 2 - static_cast<double>(smaller);
  const double z = std::max(0.0, off - 1) / (std::sqrt(squares) / 2);
  test.p = twoSided(boost::math::cdf(boost::math::complement(boost::math::normal(), z)));
  return test;
}

PairedTest signTest(const std::vector<double>& a, const std::vector<double>& b) {
  checkPairs(a, b);
  PairedTest test;
  std::size_t above = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    above += a[i] > b[i] ? 1 : 0;
    test.ties += a[i] == b[i] ? 1 : 0;
  }
  test.pairs = a.size() - test.ties;
  test.statistic = static_cast<double>(above);
  if (test.pairs == 0) return test;
  const auto smaller = static_cast<double>(std::min(above, test.pairs - above));
  test.p = twoSided(boost::math::cdf(boost::math::binomial(static_cast<double>(test.pairs), 0.5), smaller));
  return test;
}

Estimate probabilityOfImprovement(const std::vector<double>& a, const std::vector<double>& b, Better better,
                                  const std::vector<std::size_t>& strata, double confidence) {
  checkPairs(a, b);
  std::vector<double> preferences;
  preferences.reserve(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) preferences.push_back(preference(a[i], b[i], better));
  MeanOptions options;
  options.confidence = confidence;
  options.strata = strata;
  options.lowest = 0, options.highest = 1;
  auto result = meanInterval(preferences, options);
  const bool all_same = std::equal(preferences.begin() + 1, preferences.end(), preferences.begin());
  if (!all_same) return result;
  result.interval.reset();
  if (result.value != 0.5)
    result.interval = clopperPearson(result.value == 1 ? a.size() : 0, a.size(), confidence);
  return result;
}

double probabilityOfSuperiority(const std::vector<double>& a, const std::vector<double>& b, Better better) {
  checkValues(a);
  checkValues(b);
  double sum = 0;
  for (const double x : a)
    for (const double y : b) sum += preference(x, y, better);
  return sum / (static_cast<double>(a.size()) * static_cast<double>(b.size()));
}

}  // namespace slam::stats
