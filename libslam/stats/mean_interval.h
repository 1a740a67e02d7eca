#pragma once
#include <cstddef>
#include <limits>
#include <vector>

#include "libslam/stats/estimate.h"

namespace slam::stats {

struct MeanOptions {
  double confidence = 0.95;  ///< of the two-sided interval, in (0, 1)
  /// Of each value the stratum (a building, say) that it was drawn in, any numbers; none: all in one.
  std::vector<std::size_t> strata = {};
  /// What no value can pass: 0 for an error, 0 and 1 for a share. An interval stays within.
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
};

/// The mean of independent values (one per seed, say) and an interval that holds the true one as often as it
/// says, also where values are few and lean to one side, as errors do. It is Student's interval of a
/// transformed mean m, by the delta method: of log(m - lowest) where values have a lowest, of the logit of (m
/// - lowest) / (highest - lowest) where they have both, of m itself where they have none; widened by Hall's
/// transformation of the t statistic (Hall, J. R. Statist. Soc. B 54(1), 1992, section 2), which takes out
/// the skewness: upwards where values have a lowest, on both sides elsewhere. How often 0.95 holds the true
/// mean at 5, 10 and 40 values: normal 0.95, 0.95, 0.95; chi-squared of 3 degrees 0.95, 0.94, 0.94;
/// exponential 0.94, 0.94, 0.94; log-normal of sigma 0.6: 0.94, 0.94, 0.95, of sigma 1: 0.91, 0.90, 0.93. Of
/// values of which one in ten is ten times as large nothing can be known from 5 (0.53). (Resampling, BCa:
/// 0.75 to 0.84 at 5.) With strata the mean is that of all values, and only what varies within a stratum
/// counts, with Welch and Satterthwaite's degrees of freedom (Biometrics Bulletin 2(6), 1946); a stratum of
/// one value is taken to vary as the others do on average. The interval then speaks of these strata: that
/// another one would differ is not in it. No interval: one value, or no stratum of two. All values equal: of
/// width 0, which speaks of the values only. REQUIRES at least one value, all finite and within the bounds, a
/// lowest where there is a highest, confidence in (0, 1), strata for all values or none (ContractError).
/// Cost: linear.
Estimate meanInterval(const std::vector<double>& values, const MeanOptions& options = {});

/// The same for a ratio of sums, sum(parts) / sum(wholes), whose units are drawn together: runs with their
/// errors and their scans, say (Davison and Hinkley, Bootstrap Methods and their Application, 1997, section
/// 2.7.2: by the influence of each unit). Bounds are those of the ratio. REQUIRES as many parts as wholes,
/// wholes of 0 or more, not all 0.
Estimate ratioInterval(const std::vector<double>& parts, const std::vector<double>& wholes,
                       const MeanOptions& options = {});

/// REQUIRES at least one value, all finite (ContractError).
double mean(const std::vector<double>& values);

}  // namespace slam::stats
