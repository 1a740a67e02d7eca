#pragma once
#include <optional>

#include "libslam/loops/tracked_path.h"
#include "libslam/particles/motion.h"
#include "libslam/tracking/local_map.h"
#include "libslam/tracking/unskewer.h"

namespace slam::particles {

/// Sets scans right that were deskewed by a motion that errs, against the keyframes of a path; see
/// tracking::Unskewer.
class Sweeps {
 public:
  /// `past` has to stay where it is; its frame is that of all poses here.
  explicit Sweeps(const loops::TrackedPath& past)
      : past_(&past), around_(past.map()), unskewer_(past.map()) {}
  struct SetRight {
    lidar::Scan scan;
    Eigen::Matrix3d noise;  ///< covariance of its pose against the keyframes; frame of the path, m and rad
  };
  /// T_before: of the robot at the scan before. Nothing of a scan that was not deskewed, that the keyframes
  /// explain poorly, or without a keyframe.
  std::optional<SetRight> setRight(const lidar::Scan& scan, const core::Pose2& T_before, const Motion& told);

 private:
  void lookAround(const core::Pose2& T_map_robot);

  const loops::TrackedPath* past_;
  tracking::LocalMap around_;
  tracking::Unskewer unskewer_;
  int keyframes_ = 0, anchor_ = -1, revision_ = -1;  ///< of what `around_` was made
};

}  // namespace slam::particles
