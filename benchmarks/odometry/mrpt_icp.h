#pragma once
#include <memory>

#include "libslam/odometry/scan_odometry.h"

namespace odometry_bench {

/// MRPT's classic ICP (mrpt::slam::CICP), newest scan against the one before, both as point maps.
///
/// The defaults are the best of a search over all logs of the benchmark (800 scans each), by the geometric
/// mean of the drift: threshold_m 0.3, 0.5, 1; smallest_threshold_m 0.02, 0.05, 0.1; shrink 0.5, 0.8; started
/// from the step before or from rest.
struct IcpSettings {
  double threshold_m = 0.5;
  double threshold_deg = 0.15;
  double smallest_threshold_m = 0.02;
  double shrink = 0.5;  ///< ALFA
  double point_distance_m = 0;
  bool constant_velocity = true;
  int iterations = 80;
};

/// A step counts as unreliable when ICP's goodness (share of points with a partner) is below 0.5.
std::unique_ptr<slam::odometry::ScanOdometry> makeMrptIcp(const IcpSettings& settings);

}  // namespace odometry_bench
