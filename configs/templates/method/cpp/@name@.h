#pragma once
#include <optional>

#include "libslam/core/pose2.h"
#include "libslam/logs/log_reader.h"
#include "libslam/odometry/scan_odometry.h"

/// A SLAM method: told one scan after the other, it says where the robot is.
class @Name@ {
 public:
  @Name@();
  /// T_map_robot at the new scan; the map's frame is the robot's at the first one. T_previous_current: the
  /// motion since the scan before, as the wheels have it.
  slam::core::Pose2 update(const slam::lidar::Scan& scan, const slam::core::Pose2& T_previous_current);

 private:
  std::unique_ptr<slam::odometry::ScanOdometry> odometry_;
  slam::core::Pose2 T_map_robot_;
  bool is_first_ = true;
};
