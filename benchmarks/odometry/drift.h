#pragma once
#include <vector>

#include "benchmarks/odometry/bench_log.h"
#include "libslam/odometry/scan_odometry.h"

namespace odometry_bench {

/// How far increments stray from what is known of the true motion.
///
/// The motion is judged over short stretches. With exact truth: from each tenth scan until the true path has
/// grown by 1 m (Sturm et al., IROS 2012, relative pose error over a distance). With relations: each pair of
/// scans that the annotators related and that lie 0 to 5 s apart. The drift per metre is the sum of the
/// translational errors over the sum of the metres driven within the stretches; the drift per radian the sum
/// of the heading errors over the sum of the angles turned. Sums, so that long and short stretches count by
/// what happens in them and a blunder counts fully; the medians of the errors stand beside them.
///
/// The relations were made by hand and are wrong by a few centimetres themselves, about as much as a good
/// method drifts in a second. So there is a long drift too: over 10 m of the true path, or over relations 5
/// to 300 s apart, where "metres driven" is what the wheels counted between the two scans.
struct Drift {
  double per_metre = 0, per_radian = 0, long_per_metre = 0;
  double median_m = 0, median_rad = 0;  ///< error of a stretch
  size_t stretches = 0;
  size_t wrong = 0;      ///< steps (with truth) or stretches (with relations) off by more than 0.1 m
  size_t flagged = 0;    ///< steps that the method itself calls unreliable
  double median_us = 0;  ///< thread CPU time of one update
};

/// Runs one method over a log.
Drift measureDrift(const BenchLog& log, slam::odometry::ScanOdometry& odometry);

}  // namespace odometry_bench
