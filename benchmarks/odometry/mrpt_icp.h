#pragma once
#include <memory>

#include "libslam/odometry/scan_odometry.h"

namespace odometry_bench {

/// MRPT's classic ICP (mrpt::slam::CICP), newest scan against the one before, both as point maps.
///
/// Tuned by hand over all logs here, for the least drift: distance threshold 0.1 .. 1 m, its smallest value
/// 0.02 .. 0.1 m, ALFA 0.5 .. 0.9, one point per 0 .. 5 cm, started at rest or from the step before.
struct IcpSettings {
  double threshold_m = 0.5;
  double threshold_deg = 0.15;
  double smallest_threshold_m = 0.05;
  double shrink = 0.5;  ///< ALFA
  double point_distance_m = 0;
  bool constant_velocity = true;
  int iterations = 80;
};

/// A step counts as unreliable when ICP's goodness (share of points with a partner) is below 0.5.
std::unique_ptr<slam::odometry::ScanOdometry> makeMrptIcp(const IcpSettings& settings);

}  // namespace odometry_bench
