#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "libslam/calibration/estimate.h"
#include "libslam/core/pose2.h"
#include "libslam/lidar/deskew.h"
#include "libslam/lidar/scan.h"

namespace slam::calibration {

/// How long the lidar takes from its first to its last beam, by how well scans lie on one another.
struct SweepFit {
  std::size_t pairs = 0;       ///< of consecutive scans between which the robot's turning changed
  bool is_observable = false;  ///< enough of them, and one duration clearly the best
  Estimate duration_s;         ///< negative: clockwise, the last beam of the scan comes first
};

/// Judges the sweep of a lidar by the scans alone. A robot that turns all the time skews all of its scans
/// alike, and they fit on one another as if they were none; but where its turning changes, one scan is skewed
/// more than the next, and only with the right duration do both lie, deskewed (lidar::deskewed()), on one
/// another.
class SweepPairs {
 public:
  static constexpr std::size_t kMostPairs = 120;

  /// scans: how many will come, to spread the pairs over all.
  explicit SweepPairs(std::uint64_t scans);
  /// The next scan and the robot's motion since the scan before; nullopt where that is not known.
  void addScan(const lidar::Scan& scan, const std::optional<core::Pose2>& T_previous_robot);
  SweepFit fit() const;

 private:
  struct Moving {
    lidar::Scan scan;
    core::Pose2 T_previous_robot;
    double period_s = 0;
  };
  struct Pair {
    Moving from, to;
  };
  double costOf(const Pair& pair, double duration_s) const;

  std::uint64_t spacing_, since_pair_ = 0;
  std::optional<lidar::Scan> previous_scan_;
  std::optional<Moving> previous_;
  std::vector<Pair> pairs_;
};

}  // namespace slam::calibration
