#include "libslam/stats/explained_variance.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "libslam/core/error.h"
#include "libslam/core/random.h"

namespace slam::stats {
namespace {

/// Sum over the groups of their size times the square of their mean; values have mean 0.
double betweenGroups(const std::vector<double>& values, const std::vector<std::size_t>& groups,
                     std::size_t count) {
  std::vector<double> sums(count, 0);
  std::vector<double> sizes(count, 0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    sums[groups[i]] += values[i];
    sizes[groups[i]] += 1;
  }
  double between = 0;
  for (std::size_t g = 0; g < count; ++g) between += sums[g] * sums[g] / sizes[g];
  return between;
}

}  // namespace

ExplainedVariance explainedVariance(const std::vector<double>& values, const std::vector<std::size_t>& groups,
                                    std::uint64_t seed, int permutations) {
  if (values.size() != groups.size())
    throw core::ContractError("explainedVariance: expected a group for every value");
  if (std::any_of(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }))
    throw core::ContractError("explainedVariance: expected finite values");
  ExplainedVariance result;
  std::map<std::size_t, std::size_t> numbers;
  for (const auto group : groups) numbers.try_emplace(group, numbers.size());
  const std::size_t count = numbers.size(), total_count = values.size();
  if (count < 2 || count == total_count) return result;
  std::vector<std::size_t> numbered;
  numbered.reserve(total_count);
  for (const auto group : groups) numbered.push_back(numbers.at(group));
  double mean = 0, total = 0;
  for (const double v : values) mean += v / static_cast<double>(total_count);
  std::vector<double> centred;
  for (const double v : values) centred.push_back(v - mean), total += (v - mean) * (v - mean);
  if (!(total > 0)) return result;

  const double between = betweenGroups(centred, numbered, count);
  result.share = std::min(1.0, between / total);
  const double chance =
      static_cast<double>(count - 1) * (1 - result.share) / static_cast<double>(total_count - count);
  result.adjusted_share = std::max(0.0, result.share - chance);
  core::RandomStream random(seed, "explained variance");
  int as_much = 1;
  for (int k = 0; k < permutations; ++k) {
    for (std::size_t i = total_count - 1; i > 0; --i) std::swap(numbered[i], numbered[random.below(i + 1)]);
    // Ties must count whatever the order of the sum.
    as_much += betweenGroups(centred, numbered, count) >= between - 1e-12 * total ? 1 : 0;
  }
  result.p = static_cast<double>(as_much) / (permutations + 1);
  return result;
}

}  // namespace slam::stats
