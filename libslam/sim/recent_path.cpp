#include "libslam/sim/recent_path.h"

#include <algorithm>

namespace slam::sim {

void RecentPath::add(const core::Pose2& T_world_start, const robot::Command& driven, double duration_s) {
  if (memory_s_ == 0) return;
  drives_.push_back({T_world_start, driven, duration_s});
  remembered_s_ += duration_s;
  while (remembered_s_ - drives_.front().duration_s >= memory_s_) {
    remembered_s_ -= drives_.front().duration_s;
    drives_.pop_front();
  }
}

core::Pose2 RecentPath::poseBefore(const core::Pose2& T_world_now, double ago_s) const {
  if (ago_s <= 0) return T_world_now;
  core::Pose2 T_world_then = T_world_now;
  for (auto drive = drives_.rbegin(); drive != drives_.rend(); ++drive) {
    T_world_then = drive->T_world_start;
    if (ago_s < drive->duration_s) {
      const double elapsed_s = std::min(drive->duration_s - ago_s, drive->driven.duration_s);
      return T_world_then * robot::driveMotion(drive->driven, elapsed_s);
    }
    ago_s -= drive->duration_s;
  }
  return T_world_then;
}

}  // namespace slam::sim
