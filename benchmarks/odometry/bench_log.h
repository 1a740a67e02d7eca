#pragma once
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/lidar/scan.h"
#include "libslam/robot/motion_kind.h"

namespace odometry_bench {

/// Scans and whatever is known of the true motion.
struct BenchLog {
  std::string name;
  std::vector<slam::lidar::Scan> scans;
  std::vector<slam::robot::Commanded> commands;  ///< before each scan: as given, else by the wheels
  slam::core::Trajectory truth;                  ///< of the robot, one pose per scan, or empty
  slam::core::Relations relations;               ///< annotated by hand
  std::vector<slam::core::Pose2> wheels;  ///< wheel odometry, one pose per scan: only to say how far it drove
};

}  // namespace odometry_bench
