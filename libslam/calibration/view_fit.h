#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "libslam/calibration/estimate.h"
#include "libslam/calibration/motion_series.h"
#include "libslam/core/pose2.h"
#include "libslam/lidar/scan.h"

namespace slam::calibration {

/// How well the scans lie on one another when their readings are spread over another field of view.
struct ViewFit {
  struct Candidate {
    double factor = 1;  ///< times the angle between readings that the log says
    double cost = 0;    ///< mean over the pairs: 0 all on one another .. 1 nothing
  };
  std::size_t pairs = 0;
  std::vector<Candidate> candidates;  ///< by factor
  bool is_observable = false;         ///< enough pairs, and one factor clearly the best
  Estimate factor;
};

/// Judges a field of view by the scans alone. Pairs of scans some half a metre apart are matched again with
/// the readings spread over 0.4 to 2.5 times the angle. A turn tells nothing, because a sweep that is spread
/// too wide turns into itself, only further; but on a move the walls come nearer by what their bearings say,
/// and a sweep with wrong bearings fits nowhere. On real logs the best factor is within 1 % of the true one:
/// half and double steps show at once, one step more or less in 180 does not.
class ViewPairs {
 public:
  static constexpr std::size_t kMostPairs = 120;

  /// scans: how many will come, to spread the pairs over all.
  explicit ViewPairs(std::uint64_t scans);
  /// step: as of MotionSeries::addScan() for this scan.
  void addScan(const lidar::Scan& scan, const ScanStep* step);
  ViewFit fit() const;

 private:
  struct Pair {
    lidar::Scan from, to;
    core::Pose2 T_from_to;  ///< of the lidar, as matched with the stated angle
  };
  std::uint64_t spacing_, since_pair_ = 0;
  std::optional<lidar::Scan> from_;
  core::Pose2 T_from_here_;
  std::vector<Pair> pairs_;
};

}  // namespace slam::calibration
