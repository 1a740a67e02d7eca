#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

namespace slam::core {

/// The value of that rank in rising order, counted from 0: one of the values as it is, never between two. The
/// values are left in another order. REQUIRES rank < values.size() and no NaN. Cost: linear.
template <class T>
T valueOfRank(std::vector<T>& values, std::size_t rank) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The middle one, the upper of two; of none 0. REQUIRES no NaN.
template <class T>
T middleValue(std::vector<T> values) {
  return values.empty() ? T{} : valueOfRank(values, values.size() / 2);
}

}  // namespace slam::core
