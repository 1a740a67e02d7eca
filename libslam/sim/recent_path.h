#pragma once
#include <deque>

#include "libslam/core/pose2.h"
#include "libslam/robot/drive.h"

namespace slam::sim {

/// Where the robot truly was a moment ago, for sensors that take time.
class RecentPath {
 public:
  /// Remembers at least the last `memory_s`; 0 remembers nothing and costs nothing.
  explicit RecentPath(double memory_s) : memory_s_(memory_s) {}

  /// From T_world_start the robot did `driven` and stood still for the rest of `duration_s`.
  void add(const core::Pose2& T_world_start, const robot::Command& driven, double duration_s);
  /// Its pose `ago_s` before the present one, exactly on the driven arc. Before the first command, or where
  /// memory ends, it stood where that began. `T_world_now` itself for ago_s = 0.
  core::Pose2 poseBefore(const core::Pose2& T_world_now, double ago_s) const;

 private:
  struct Drive {
    core::Pose2 T_world_start;
    robot::Command driven;
    double duration_s;
  };

  double memory_s_, remembered_s_ = 0;
  std::deque<Drive> drives_;  ///< the newest last
};

}  // namespace slam::sim
