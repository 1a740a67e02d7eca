#pragma once
#include <cstddef>

#include "libslam/core/pose2.h"

namespace slam::metrics {

/// Summary of a list of non-negative errors. All NaN when there are none, so that nothing passes silently.
struct ErrorStatistics {
  std::size_t count = 0;
  double mean, rmse, median, p95, max;
};

/// Absolute trajectory error (Sturm et al., IROS 2012): the estimate is moved rigidly, SE(2), by the
/// least-squares alignment of positions (Umeyama, PAMI 1991, without scale) onto the truth; then distances,
/// and headings.
struct TrajectoryError {
  ErrorStatistics position_m;    ///< ATE
  ErrorStatistics heading_rad;   ///< |heading error| after the same alignment
  core::Pose2 T_truth_estimate;  ///< the alignment
  std::size_t unmatched = 0;     ///< estimated poses without a truth within reach (outside its time span)
};

/// Truth is interpolated to the estimate's stamps. Stamps within 1 ms are the same. No common stamp: all NaN.
/// A pose that is not finite makes the statistics NaN. One matched pose: aligned by that pose.
TrajectoryError trajectoryError(const core::Trajectory& truth, const core::Trajectory& estimate);

/// Relative pose error (same source): over pairs of stamps the error of the estimated relative motion, no
/// alignment.
struct RelativeError {
  ErrorStatistics translation_m;
  ErrorStatistics rotation_rad;
};
/// Pairs whose true path between them is `distance_m` (the first pose at or past it, from every start).
RelativeError relativeErrorOverDistance(const core::Trajectory& truth, const core::Trajectory& estimate,
                                        double distance_m);
/// Pairs `interval_s` apart.
RelativeError relativeErrorOverTime(const core::Trajectory& truth, const core::Trajectory& estimate,
                                    double interval_s);

/// Truth at a time, interpolated; false outside its span (1 ms slack).
bool poseAt(const core::Trajectory& trajectory, double time_s, core::Pose2& pose);

}  // namespace slam::metrics
