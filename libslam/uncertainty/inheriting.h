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
  /// What follows begins at a keyframe; -1: none that is known. A robot that is hung on others meanwhile goes
  /// on as before: where their surfaces tell nothing, it errs by what it came with, not by what they do.
  void begin(int keyframe) { gain_.setZero(), own_.setZero(), before_ = keyframe; }

 private:
  Eigen::Matrix3d gain_ = Eigen::Matrix3d::Zero(), own_ = Eigen::Matrix3d::Zero();
  double points_err_ = 1;  ///< of the last scan
  int before_ = -1;        ///< keyframe that this began at
};

}  // namespace slam::uncertainty
