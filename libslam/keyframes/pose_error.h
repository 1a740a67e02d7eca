#pragma once
#include <Eigen/Core>
#include <memory>

#include "libslam/core/pose2.h"
#include "libslam/keyframes/keyframe_map.h"
#include "libslam/scanmatch/surfel_matcher.h"

namespace slam::keyframes {

/// What is known of the robot's pose before a match, and of the way from there; map frame.
struct Before {
  core::Pose2 T_map_robot;
  Eigen::Matrix3d covariance;
  Eigen::Matrix3d odometry;  ///< covariance of the step since, as odometry has it
};
/// What a matched pose errs by; map frame.
struct PoseError {
  Eigen::Matrix3d noise;       ///< against the map as it was
  Eigen::Matrix3d covariance;  ///< in the map
  Eigen::Matrix3d least;       ///< one match, and odometry where that leaves directions open
  Eigen::Matrix3d stays;       ///< how much of an error before is left
};

/// The matched pose is a mean of what the map and odometry say, with the weights that matching gave them: its
/// error is that mean of their errors. Errors of views that share a past are taken as wholly correlated.
/// While the map has one keyframe, what that saw errs by the match's noise, too. For the rooms of graph SLAM
/// only.
PoseError errorAfterMatch(const KeyframeMap& map, const scanmatch::MatchEvidence& evidence,
                          const Eigen::Matrix3d& posterior_information, const core::Pose2& T_map_robot,
                          const Before& before);

/// From where the newest keyframe's pose is known, and how well: by what its covariance has grown since, and
/// no better than `least`, what one match tells.
void noteMatch(KeyframeMap& map, const scanmatch::MatchEvidence& evidence, const Eigen::Matrix3d& least);

/// A scan by the keyframe that it hangs on.
struct HungScan {
  int keyframe;
  core::Pose2 T_keyframe_robot;
  Eigen::Matrix3d drift_covariance;  ///< beyond the keyframe's; map frame
};

/// How sure a map's scans are of one another, by all that is known when this is made: see
/// KeyframeMap::witnesses(). What two scans that hang on one keyframe err by is taken as independent. For the
/// rooms of graph SLAM only.
class RelativeError {
 public:
  /// REQUIRES a keyframe. The map has to outlive this, and its poses to stay.
  explicit RelativeError(const KeyframeMap& map);
  /// Covariance of x (m), y (m), phi (rad) of b's pose in a's frame. Cost: two chains of an elimination tree.
  Eigen::Matrix3d covariance(const HungScan& a, const HungScan& b) const;

 private:
  const KeyframeMap& map_;
  std::shared_ptr<const posegraph::Marginals> keyframes_;
};

}  // namespace slam::keyframes
