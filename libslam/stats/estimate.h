#pragma once
#include <optional>

namespace slam::stats {

struct Interval {
  double low = 0, high = 0;
};

/// A figure and how sure it is. No interval: what it was made from does not say.
struct Estimate {
  double value = 0;
  std::optional<Interval> interval;
};

}  // namespace slam::stats
