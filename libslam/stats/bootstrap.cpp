#include "libslam/stats/bootstrap.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/core/middle_value.h"
#include "libslam/core/random.h"
#include "libslam/stats/mean_interval.h"

namespace slam::stats {
namespace {

void check(const BootstrapOptions& options) {
  if (!(options.confidence > 0 && options.confidence < 1))
    throw core::ContractError("bootstrapInterval: confidence must lie in (0, 1)");
  if (options.resamples < 100) throw core::ContractError("bootstrapInterval: at least 100 resamples");
}

void check(const std::vector<double>& values) {
  if (values.empty()) throw core::ContractError("a median of no values");
  if (std::any_of(values.begin(), values.end(), [](double value) { return std::isnan(value); }))
    throw core::ContractError("a median of a value that is not a number");
}

double valueOf(const IndexStatistic& statistic, const std::vector<std::size_t>& indices) {
  const double value = statistic(indices);
  if (std::isnan(value)) throw core::ContractError("bootstrapInterval: the statistic is not a number");
  return value;
}

/// Indices of the units, stratum by stratum.
using Strata = std::vector<std::vector<std::size_t>>;

Strata strataOf(std::size_t count, const BootstrapOptions& options) {
  if (!options.strata.empty() && options.strata.size() != count)
    throw core::ContractError("bootstrapInterval: strata for " + std::to_string(options.strata.size()) +
                              " of " + std::to_string(count) + " values");
  std::map<std::size_t, std::vector<std::size_t>> by_number;
  for (std::size_t i = 0; i < count; ++i)
    by_number[options.strata.empty() ? 0 : options.strata[i]].push_back(i);
  Strata strata;
  for (auto& [number, units] : by_number) strata.push_back(std::move(units));
  return strata;
}

std::vector<double> resampled(const Strata& strata, const IndexStatistic& statistic,
                              const BootstrapOptions& options) {
  core::RandomStream random(options.seed, "bootstrap");
  std::vector<std::size_t> indices;
  std::vector<double> values(static_cast<std::size_t>(options.resamples));
  for (double& value : values) {
    indices.clear();
    for (const auto& units : strata)
      for (std::size_t i = 0; i < units.size(); ++i) indices.push_back(units[random.below(units.size())]);
    value = valueOf(statistic, indices);
  }
  std::sort(values.begin(), values.end());
  return values;
}

/// Efron 1987, equation 7.3: a sixth of the skewness of the influences, here the jackknife's; of several
/// strata as Davison and Hinkley have it. 0 where all are equal.
double jackknifeAcceleration(const Strata& strata, const IndexStatistic& statistic) {
  double squares = 0, cubes = 0;
  for (const auto& units : strata) {
    if (units.size() < 2) continue;
    std::vector<double> without;
    for (const std::size_t left_out : units) {
      std::vector<std::size_t> others;
      for (const auto& stratum : strata)
        std::copy_if(stratum.begin(), stratum.end(), std::back_inserter(others),
                     [&](std::size_t unit) { return unit != left_out; });
      without.push_back(valueOf(statistic, others));
    }
    const double centre = mean(without);
    const auto size = static_cast<double>(units.size());
    for (const double value : without) {
      const double influence = (size - 1) / size * (centre - value);
      squares += influence * influence;
      cubes += influence * influence * influence;
    }
  }
  return squares > 0 ? cubes / (6 * core::pow(squares, 1.5)) : 0;
}

/// The share of resamples below the estimate as a normal deviate; a resample equal to it counts half.
std::optional<double> biasCorrection(const std::vector<double>& sorted, double estimate) {
  const auto range = std::equal_range(sorted.begin(), sorted.end(), estimate);
  const auto below = static_cast<double>(range.first - sorted.begin());
  const auto equal = static_cast<double>(range.second - range.first);
  const double share = (below + equal / 2) / static_cast<double>(sorted.size());
  if (share <= 0 || share >= 1) return std::nullopt;
  return boost::math::quantile(boost::math::normal(), share);
}

/// The resample at the level: the (B + 1) * level-th, by linear interpolation.
double atLevel(const std::vector<double>& sorted, double level) {
  const double position = std::clamp(level * static_cast<double>(sorted.size() + 1) - 1, 0.0,
                                     static_cast<double>(sorted.size() - 1));
  const auto below = static_cast<std::size_t>(position);
  const double fraction = position - static_cast<double>(below);
  if (fraction == 0 || std::isinf(sorted[below])) return sorted[below];
  return sorted[below] + fraction * (sorted[below + 1] - sorted[below]);
}

/// Efron 1987, equation 2.3: the level that stands for `level` once bias and acceleration are taken out.
std::optional<double> correctedLevel(double level, double bias, double acceleration) {
  const boost::math::normal normal;
  const double shifted = bias + boost::math::quantile(normal, level);
  const double scale = 1 - acceleration * shifted;
  if (!(scale > 0)) return std::nullopt;
  return boost::math::cdf(normal, bias + shifted / scale);
}

Estimate intervalOf(std::size_t count, const IndexStatistic& statistic, const BootstrapOptions& options,
                    bool accelerated) {
  check(options);
  if (count == 0) throw core::ContractError("bootstrapInterval: no values");
  std::vector<std::size_t> all(count);
  std::iota(all.begin(), all.end(), std::size_t{0});
  Estimate result{valueOf(statistic, all), std::nullopt};
  const auto strata = strataOf(count, options);
  if (std::all_of(strata.begin(), strata.end(), [](const auto& units) { return units.size() == 1; }))
    return result;

  const auto sorted = resampled(strata, statistic, options);
  const double tail = (1 - options.confidence) / 2;
  result.interval = Interval{atLevel(sorted, tail), atLevel(sorted, 1 - tail)};
  const auto bias = biasCorrection(sorted, result.value);
  if (!bias) return result;
  const double acceleration = accelerated ? jackknifeAcceleration(strata, statistic) : 0;
  const auto low = correctedLevel(tail, *bias, acceleration);
  const auto high = correctedLevel(1 - tail, *bias, acceleration);
  if (low && high) result.interval = Interval{atLevel(sorted, *low), atLevel(sorted, *high)};
  return result;
}

/// The middle between two neighbours of an order.
double between(double below, double above) {
  if (std::isinf(below) && std::isinf(above) && below != above)
    throw core::ContractError("median: infinite values of both signs have no middle");
  return std::isinf(below) ? below : below + (above - below) / 2;
}

/// median() of values drawn by their indices, thousands of times: counts how often each was drawn, in their
/// order.
class MedianOfDrawn {
 public:
  explicit MedianOfDrawn(const std::vector<double>& values)
      : sorted_(values.size()), place_(values.size()), counts_(values.size()) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t i, std::size_t j) { return values[i] < values[j]; });
    for (std::size_t k = 0; k < order.size(); ++k) sorted_[k] = values[order[k]], place_[order[k]] = k;
  }

  double operator()(const std::vector<std::size_t>& indices) {
    std::fill(counts_.begin(), counts_.end(), 0U);
    for (const std::size_t i : indices) ++counts_[place_[i]];
    const std::size_t middle = indices.size() / 2;  // counted from 0
    std::size_t k = 0, passed = counts_[0];
    while (passed < middle) passed += counts_[++k];
    const double below = sorted_[k];  // of rank middle - 1 (or where nothing lies below the middle)
    while (passed <= middle) passed += counts_[++k];
    return indices.size() % 2 == 1 ? sorted_[k] : between(below, sorted_[k]);
  }

 private:
  std::vector<double> sorted_;
  std::vector<std::size_t> place_;
  std::vector<unsigned> counts_;
};

}  // namespace

double median(std::vector<double> values) {
  check(values);
  const std::size_t half = values.size() / 2;
  const double upper = core::valueOfRank(values, half);
  if (values.size() % 2 == 1) return upper;
  return between(*std::max_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(half)),
                 upper);
}

Estimate bootstrapMedian(const std::vector<double>& values, const BootstrapOptions& options) {
  check(values);
  return intervalOf(values.size(), MedianOfDrawn(values), options, false);
}

Estimate bootstrapInterval(std::size_t count, const IndexStatistic& statistic,
                           const BootstrapOptions& options) {
  return intervalOf(count, statistic, options, true);
}

}  // namespace slam::stats
