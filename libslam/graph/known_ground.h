#pragma once
#include <vector>

#include "libslam/graph/change_marks.h"
#include "libslam/keyframes/keyframe_map.h"

namespace slam::graph {

/// Ground that was seen often enough costs no more: the robot goes on along the keyframes that are there (the
/// idea of a reduced pose graph: Johannsson et al., ICRA 2013). So time and memory grow with the area, and
/// not with the years. What has stood somewhere for a while makes a keyframe, in place of the oldest there;
/// what has gone is taken out.
class KnownGround {
 public:
  /// `map` has to stay where it is.
  explicit KnownGround(keyframes::KeyframeMap& map) : map_(&map), options_(&map.options()) {}

  /// Whether keyframes around see all that a scan sees, often enough, so that one more tells nothing.
  bool isKnown(const lidar::Scan& scan, const core::Pose2& T_map_robot, const std::vector<int>& near) const;
  /// Whether something has been there for a while where none of the keyframes near saw it. What has gone is
  /// forgotten, of those that are linked with `anchor`.
  bool hasChanged(const lidar::Scan& scan, const std::vector<scanmatch::PatchPoint>& points,
                  const core::Pose2& T_map_robot, const std::vector<int>& near, int anchor);
  /// Keyframe k, made on known ground, takes the place of the oldest one that sees the same.
  void retireOldest(int k);

 private:
  void forgetGone(const lidar::Scan& scan, const core::Pose2& T_map_robot, int anchor);

  keyframes::KeyframeMap* map_;
  const keyframes::GraphOptions* options_;
  ChangeMarks appeared_, gone_;
};

}  // namespace slam::graph
