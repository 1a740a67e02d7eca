#pragma once
#include <cmath>

namespace slam::calibration {

/// A figure found from data, with the ends of its 95 % interval.
struct Estimate {
  double value = 0, low = 0, high = 0;
  double width() const { return high - low; }
  bool covers(double x) const { return low <= x && x <= high; }
  /// How far x lies outside of the interval; 0 inside.
  double distanceTo(double x) const {
    return covers(x) ? 0 : std::fmin(std::fabs(x - low), std::fabs(x - high));
  }
};

}  // namespace slam::calibration
