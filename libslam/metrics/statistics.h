#pragma once
#include <cstddef>
#include <limits>
#include <vector>

namespace slam::metrics {

/// The value below which `share` (0 to 1) of the values lie, by linear interpolation between the order
/// statistics: position share * (n - 1), counted from 0 (Hyndman and Fan, The American Statistician 50(4),
/// 1996, definition 7). share 0.5 is the median. No value, or one that is NaN: NaN.
double quantile(std::vector<double> values, double share);

/// Summary of a list of non-negative errors. All NaN when there are none or when one of them is not finite,
/// so that nothing passes silently. median and p95 are quantile()s.
struct ErrorStatistics {
  std::size_t count = 0;
  double mean = std::numeric_limits<double>::quiet_NaN();
  double rmse = std::numeric_limits<double>::quiet_NaN();
  double median = std::numeric_limits<double>::quiet_NaN();
  double p95 = std::numeric_limits<double>::quiet_NaN();
  double max = std::numeric_limits<double>::quiet_NaN();
};
ErrorStatistics errorStatistics(const std::vector<double>& errors);

}  // namespace slam::metrics
