#include "libslam/metrics/statistics.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/error.h"
#include "libslam/core/numbers.h"

namespace slam::metrics {
namespace {

using core::kNaN;

double quantileOfSorted(const std::vector<double>& sorted, double share) {
  const double position = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<size_t>(position);
  const double fraction = position - static_cast<double>(below);
  // Without this an infinite neighbour would turn a finite order statistic into 0 * infinity.
  if (fraction == 0) return sorted[below];
  return sorted[below] + fraction * (sorted[below + 1] - sorted[below]);
}

}  // namespace

double quantile(std::vector<double> values, double share) {
  if (!(share >= 0 && share <= 1)) throw core::ContractError("quantile: share must lie in 0 to 1");
  // A NaN has no place in an order, so it must not reach std::sort.
  if (values.empty() || std::any_of(values.begin(), values.end(), [](double v) { return std::isnan(v); }))
    return kNaN;
  std::sort(values.begin(), values.end());
  return quantileOfSorted(values, share);
}

ErrorStatistics errorStatistics(const std::vector<double>& errors) {
  ErrorStatistics result;
  result.count = errors.size();
  if (errors.empty() || !std::all_of(errors.begin(), errors.end(), [](double e) { return std::isfinite(e); }))
    return result;
  double sum = 0, sum_of_squares = 0;
  for (const double e : errors) sum += e, sum_of_squares += e * e;
  const auto n = static_cast<double>(errors.size());
  auto sorted = errors;
  std::sort(sorted.begin(), sorted.end());
  result.mean = sum / n;
  result.rmse = std::sqrt(sum_of_squares / n);
  result.median = quantileOfSorted(sorted, 0.5);
  result.p95 = quantileOfSorted(sorted, 0.95);
  result.max = sorted.back();
  return result;
}

}  // namespace slam::metrics
