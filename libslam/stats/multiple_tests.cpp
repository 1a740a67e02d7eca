#include "libslam/stats/multiple_tests.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

#include "libslam/core/error.h"

namespace slam::stats {

std::vector<double> holm(const std::vector<double>& p_values) {
  for (const double p : p_values)
    if (!(p >= 0 && p <= 1)) throw core::ContractError("holm: a p-value outside [0, 1]");
  std::vector<std::size_t> order(p_values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t i, std::size_t j) { return p_values[i] < p_values[j]; });
  std::vector<double> adjusted(p_values.size());
  double largest = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto still_open = static_cast<double>(order.size() - k);
    largest = std::max(largest, std::min(1.0, still_open * p_values[order[k]]));
    adjusted[order[k]] = largest;
  }
  return adjusted;
}

}  // namespace slam::stats
