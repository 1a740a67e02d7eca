#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/lidar/scan.h"
#include "libslam/odometry/scan_odometry.h"

namespace slam::calibration {

/// What scan matching says of the time between two consecutive scans of one lidar, in the lidar's own frame:
/// no mounting is believed.
struct ScanStep {
  double from_s = 0, to_s = 0;
  core::Pose2 T_previous_lidar;
  bool is_matched = false;   ///< the two scans lie on one another somehow
  bool is_reliable = false;  ///< and in every direction
};

/// A stretch of a log without a break: the lidar's steps, one after the other, and the odometry beside them.
struct Stretch {
  std::vector<ScanStep> steps;
  /// T_odom_robot by the name of the odometry's stream; sorted by stamp once it is finished.
  std::map<std::string, std::vector<core::StampedPose>> odometry;
};

/// Matches each scan with the one before (plicp) and keeps the odometry beside it. At most kMostSteps scans
/// are matched: a longer log is seen in evenly spread stretches.
class MotionSeries {
 public:
  static constexpr std::uint64_t kMostSteps = 20000;

  /// scans: how many will come. shortest_s: odometry readings nearer than this to the last one kept are
  /// passed over.
  MotionSeries(std::uint64_t scans, double shortest_s);

  void addOdometry(const std::string& stream, const core::StampedPose& reading);
  /// The step that ends with this scan; nullptr for the first scan of a stretch and between stretches.
  const ScanStep* addScan(const lidar::Scan& scan);
  void finish();
  const std::vector<Stretch>& stretches() const { return stretches_; }

 private:
  bool isWanted(std::uint64_t scan) const;

  std::uint64_t seen_ = 0, stretch_length_, period_;
  double shortest_s_;
  std::unique_ptr<odometry::ScanOdometry> matcher_;
  std::optional<double> previous_s_;  ///< stamp of the scan before, inside a stretch
  std::vector<Stretch> stretches_;
  std::map<std::string, core::StampedPose> waiting_;  ///< the newest readings before a stretch
};

/// One stream of a stretch's odometry as a function of time.
class OdometryCurve {
 public:
  OdometryCurve(const Stretch& stretch, const std::string& stream);
  /// Straight between the readings; nullopt outside of them or inside a gap of more than 2 s. The heading is
  /// unwrapped.
  std::optional<core::Pose2> at(double time_s) const;

 private:
  std::vector<core::StampedPose> readings_;
  mutable std::size_t near_ = 0;  ///< where the last question was answered
};

}  // namespace slam::calibration
