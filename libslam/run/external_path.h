#pragma once
#include <string>
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::run {

/// A scan of a log, as far as a trajectory needs it.
struct ScanPlace {
  double time_s;
  core::Pose2 T_odom_robot;
};

/// A trajectory file held against the contract. `path` is empty when there are violations; at most the first
/// 20 are named, then their number. `name` stands for the file.
struct CheckedPath {
  std::vector<std::string> violations;
  core::Trajectory path;
  int filled_poses = 0;
};
CheckedPath checkPath(const std::string& text, const std::string& name, const std::vector<ScanPlace>& scans);

}  // namespace slam::run
