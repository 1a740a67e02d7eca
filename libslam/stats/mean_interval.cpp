#include "libslam/stats/mean_interval.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <map>
#include <numeric>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"

namespace slam::stats {
namespace {

void checkFinite(const std::vector<double>& values) {
  if (values.empty()) throw core::ContractError("a mean of no values");
  if (!std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); }))
    throw core::ContractError("a mean of a value that is not finite");
}

void check(std::size_t count, const MeanOptions& options) {
  if (!(options.confidence > 0 && options.confidence < 1))
    throw core::ContractError("meanInterval: confidence must lie in (0, 1)");
  if (!options.strata.empty() && options.strata.size() != count)
    throw core::ContractError("meanInterval: strata for some of the values only");
  if (std::isinf(options.lowest) && !std::isinf(options.highest))
    throw core::ContractError("meanInterval: a highest value without a lowest one");
}

void checkWithin(const std::vector<double>& values, const MeanOptions& options) {
  for (const double value : values)
    if (value < options.lowest || value > options.highest)
      throw core::ContractError("meanInterval: a value that passes its bounds");
}

/// How a mean spreads: of the sum of all strata.
struct Spread {
  double standard_error = 0;
  double skewness = 0;  ///< of the mean, third cumulant over standard_error cubed
  double degrees_of_freedom = 0;
};

struct Stratum {
  double count = 0, sum = 0;
  double squares = 0, cubes = 0;  ///< of differences from the mean
};

/// Of the mean of values, each the deviation of a unit. nullopt: no stratum has two.
std::optional<Spread> spreadOf(const std::vector<double>& deviations,
                               const std::vector<std::size_t>& numbers) {
  std::map<std::size_t, Stratum> strata;
  const auto numberOf = [&](std::size_t i) { return numbers.empty() ? 0 : numbers[i]; };
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    auto& stratum = strata[numberOf(i)];
    stratum.count += 1;
    stratum.sum += deviations[i];
  }
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    auto& stratum = strata[numberOf(i)];
    const double difference = deviations[i] - stratum.sum / stratum.count;
    stratum.squares += difference * difference;
    stratum.cubes += difference * difference * difference;
  }
  double variance = 0, cumulant = 0, of_freedom = 0, shared = 0, inner = 0, singles = 0;
  for (const auto& [number, stratum] : strata) {
    if (stratum.count < 2) {
      ++singles;
      continue;
    }
    const double of_sum = stratum.count * stratum.squares / (stratum.count - 1);
    variance += of_sum;
    cumulant += stratum.cubes;
    of_freedom += of_sum * of_sum / (stratum.count - 1);
    shared += stratum.squares;
    inner += stratum.count - 1;
  }
  if (inner == 0) return std::nullopt;
  Spread spread;
  spread.degrees_of_freedom = of_freedom > 0 ? variance * variance / of_freedom : inner;
  variance += singles * shared / inner;
  spread.standard_error = std::sqrt(variance) / static_cast<double>(deviations.size());
  if (shared > 0) spread.skewness = cumulant / core::pow(shared, 1.5);
  return spread;
}

/// Hall's transformation inverted: where the t statistic lies whose transform is z.
double hallQuantile(double z, double skewness) {
  if (std::abs(skewness) < 1e-9) return z;
  return (core::cbrt(1 + skewness * (z - skewness / 6)) - 1) * 3 / skewness;
}

/// `deviations`: what each unit adds to the mean, times their number.
Estimate around(double value, const std::vector<double>& deviations, const MeanOptions& options) {
  Estimate result{value, std::nullopt};
  const auto spread = spreadOf(deviations, options.strata);
  if (!spread) return result;
  const double error = spread->standard_error;
  if (error == 0) {
    result.interval = Interval{value, value};
    return result;
  }
  const double t = boost::math::quantile(boost::math::students_t(spread->degrees_of_freedom),
                                         0.5 + options.confidence / 2);
  const Interval hall = {value - error * hallQuantile(t, spread->skewness),
                         value - error * hallQuantile(-t, spread->skewness)};
  const double above = value - options.lowest, below = options.highest - value;
  if (std::isinf(above)) {
    result.interval = Interval{std::min(hall.low, value - t * error), std::max(hall.high, value + t * error)};
  } else if (std::isinf(below)) {
    const double factor = core::exp(t * error / above);
    result.interval =
        Interval{options.lowest + above / factor, std::max(hall.high, options.lowest + above * factor)};
  } else {
    const double range = above + below;
    const double factor = core::exp(t * error * range / (above * below));
    result.interval =
        Interval{std::min(hall.low, options.lowest + range * above / (above + below * factor)),
                 std::max(hall.high, options.highest - range * below / (below + above * factor))};
  }
  result.interval->low = std::max(result.interval->low, options.lowest);
  result.interval->high = std::min(result.interval->high, options.highest);
  return result;
}

}  // namespace

double mean(const std::vector<double>& values) {
  checkFinite(values);
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

Estimate meanInterval(const std::vector<double>& values, const MeanOptions& options) {
  checkFinite(values);
  check(values.size(), options);
  checkWithin(values, options);
  return around(mean(values), values, options);
}

Estimate ratioInterval(const std::vector<double>& parts, const std::vector<double>& wholes,
                       const MeanOptions& options) {
  checkFinite(parts);
  checkFinite(wholes);
  if (parts.size() != wholes.size()) throw core::ContractError("ratioInterval: a part without its whole");
  check(parts.size(), options);
  const double whole = mean(wholes);
  if (!(whole > 0) || *std::min_element(wholes.begin(), wholes.end()) < 0)
    throw core::ContractError("ratioInterval: wholes that are negative, or all zero");
  const double ratio = mean(parts) / whole;
  if (ratio < options.lowest || ratio > options.highest)
    throw core::ContractError("ratioInterval: a ratio that passes its bounds");
  std::vector<double> influences(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) influences[i] = (parts[i] - ratio * wholes[i]) / whole;
  return around(ratio, influences, options);
}

}  // namespace slam::stats
