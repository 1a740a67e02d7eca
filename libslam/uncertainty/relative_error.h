#pragma once
#include <Eigen/Core>
#include <memory>

#include "libslam/core/pose2.h"
#include "libslam/keyframes/keyframe_map.h"
#include "libslam/uncertainty/error_flow.h"

namespace slam::uncertainty {

/// A scan by the keyframe that it hangs on.
struct HungScan {
  int keyframe;
  core::Pose2 T_keyframe_robot;
  Eigen::Matrix3d drift_covariance;  ///< beyond the keyframe's; map frame
};

/// How sure a map's scans are of one another, by all that is known when this is made: see ErrorFlow. What two
/// scans that hang on one keyframe err by is taken as independent. For the rooms of graph SLAM only.
class RelativeError {
 public:
  /// REQUIRES a keyframe. The map has to outlive this, and its poses to stay.
  RelativeError(const keyframes::KeyframeMap& map, Poses poses);
  /// Covariance of x (m), y (m), phi (rad) of b's pose in a's frame. Cost: two chains of an elimination tree.
  Eigen::Matrix3d covariance(const HungScan& a, const HungScan& b) const;

 private:
  const keyframes::KeyframeMap& map_;
  std::shared_ptr<const ErrorFlow> flow_;
};

}  // namespace slam::uncertainty
