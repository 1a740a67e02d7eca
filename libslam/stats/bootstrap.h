#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "libslam/stats/estimate.h"

namespace slam::stats {

struct BootstrapOptions {
  double confidence = 0.95;  ///< of the two-sided interval, in (0, 1)
  std::uint64_t seed = 1;    ///< of the stream "bootstrap": the same seed, the same interval
  int resamples = 10000;     ///< at least 100
  /// Of each value the stratum (a building, say) that it was drawn in, any numbers; none: all in one.
  std::vector<std::size_t> strata = {};
};

/// The median of independent values (one per seed, say) and its interval by resampling them with replacement:
/// bias-corrected (Efron, JASA 82, 1987, equation 2.3; DiCiccio and Efron, Statistical Science 11, 1996,
/// section 2) and not accelerated, since the jackknife is inconsistent there (Efron and Tibshirani, An
/// Introduction to the Bootstrap, 1993, section 10.6). Where that is undefined (every resample lies on one
/// side of the estimate, or its corrected level leaves (0, 1)) the interval is the percentile one; all values
/// equal: of width 0, which speaks of the values only. With one value: no interval. 0.95 covers the median
/// 0.93 of the time from 5 values on. A mean's interval by resampling is far too narrow where values are few:
/// meanInterval().
/// With strata each resample draws as many of each stratum as there are, from that stratum alone. The
/// interval then speaks of these strata: that another one would differ is not in it. A stratum of one value
/// has nothing to vary; where all are such, there is no interval.
/// Values may be infinite (runs that failed), of one sign. REQUIRES at least one value, none NaN, options
/// within their bounds, strata for all values or none (ContractError). Cost: resamples times values.
Estimate bootstrapMedian(const std::vector<double>& values, const BootstrapOptions& options = {});

/// The same for any statistic of `count` independent units, its acceleration from the jackknife (BCa; of
/// strata as Davison and Hinkley have it, Bootstrap Methods and their Application, 1997, sections 3.2 and
/// 5.3.2). `statistic` takes the indices of the units drawn, in any order and repeated, and gives a number
/// that is not NaN. It is called resamples + count + 1 times.
using IndexStatistic = std::function<double(const std::vector<std::size_t>& indices)>;
Estimate bootstrapInterval(std::size_t count, const IndexStatistic& statistic,
                           const BootstrapOptions& options = {});

/// The value in the middle, or between the two in the middle. REQUIRES as bootstrapMedian().
double median(std::vector<double> values);

}  // namespace slam::stats
