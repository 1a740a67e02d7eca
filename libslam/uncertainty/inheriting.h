#pragma once
#include <Eigen/Core>

#include "libslam/keyframes/inheritance.h"
#include "libslam/scanmatch/surfel_matcher.h"
#include "libslam/uncertainty/pose_error.h"

namespace slam::uncertainty {

/// Gathers an Inheritance from one keyframe to the next, over the scans between. For the rooms of graph SLAM
/// only.
class Inheriting {
 public:
  /// The next scan. `since`: of an error before in the pose now, see keyframes::moved(); `odometry`:
  /// covariance of the step.
  void carryOn(const PoseError& match, const Eigen::Matrix3d& since, const Eigen::Matrix3d& odometry);
  /// A keyframe at the scan at hand, which tells this.
  keyframes::Inheritance of(const scanmatch::MatchEvidence& evidence) const;
  /// What follows hangs on a keyframe.
  void beginKeyframe() { gain_.setZero(), own_.setZero(); }

 private:
  Eigen::Matrix3d gain_ = Eigen::Matrix3d::Zero(), own_ = Eigen::Matrix3d::Zero();
  double points_err_ = 1;  ///< of the last scan
};

}  // namespace slam::uncertainty
