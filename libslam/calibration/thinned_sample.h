#pragma once
#include <cstddef>
#include <vector>

namespace slam::calibration {

/// Quantiles of a long series in bounded memory: every value up to 65536 of them, then every second, every
/// fourth and so on, evenly over the series. The same series gives the same sample.
class ThinnedSample {
 public:
  void add(double value);
  /// Values given, not values kept.
  std::size_t count() const { return count_; }
  /// The kept value that `share` of the kept ones lie below, by rank; 0 without values.
  double quantile(double share) const;
  double median() const { return quantile(0.5); }

 private:
  std::vector<double> kept_;
  std::size_t stride_ = 1, count_ = 0;
};

}  // namespace slam::calibration
