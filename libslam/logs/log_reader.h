#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "libslam/core/pose2.h"
#include "libslam/robot/scan.h"

namespace slam::logs {

/// One scan with the odometry that belongs to it.
struct LogEntry {
  robot::Scan scan;
  core::Pose2 T_odom_robot;      ///< accumulated odometry at the scan, starting at the identity
  core::Pose2 T_previous_robot;  ///< its increment since the entry before (identity for the first)
  bool has_odometry = false;     ///< false: the log gave none for this step, the two above do not move
};

/// Reads an MRPT rawlog of either form (actions with sensory frames, or bare observations), streaming: memory
/// does not grow with the log. Bare observations: each 2D scan with the newest odometry at or before it.
/// Several lidars: the label with the most scans in the first 100 entries unless `sensor_label` names one.
/// Errors (InputError with path): missing, a folder, not a rawlog, truncated or corrupt: with the byte offset
/// in the (compressed) file and the number of good entries before it. Other observations are skipped and
/// counted.
class LogReader {
 public:
  explicit LogReader(const std::string& path, const std::string& sensor_label = "");
  ~LogReader();
  /// The next scan, or nullopt at the proper end of the log.
  std::optional<LogEntry> next();
  /// How far in the file, 0..1, for progress.
  double fractionRead() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// What `rasterslam info` says of a log. Reads it whole, streaming.
struct LogInfo {
  std::string path, form;  ///< form: "action / sensory frame" or "observation only"
  std::uint64_t file_bytes = 0, entries = 0, scans = 0, odometry_readings = 0, other_observations = 0;
  double first_time_s = 0, last_time_s = 0;
  std::string sensor_label;
  int beams = 0;
  double fov_rad = 0, step_rad = 0, max_range_m = 0;
  core::Pose2 T_robot_lidar;
  double odometry_length_m = 0, median_scan_period_s = 0, longest_gap_s = 0;
  double no_return_share = 0, lost_share = 0;  ///< of all readings
  bool stamps_run_back = false;
};
LogInfo inspectLog(const std::string& path);

/// InputError when the log holds no scan, or scans of one beam ("… holds 0 laser scans, expected at least
/// 1").
void requireUsable(const LogInfo& info);

}  // namespace slam::logs
