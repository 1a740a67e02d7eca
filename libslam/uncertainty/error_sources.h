#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "libslam/keyframes/keyframe_map.h"

namespace slam::uncertainty {

/// Where the errors of a map's keyframes come from, by all that is known when this is made. A copy, so that
/// the map may grow meanwhile. For the rooms of graph SLAM only.
struct ErrorSources {
  explicit ErrorSources(const keyframes::KeyframeMap& map);
  /// That an edge measures the way between two keyframes; body frame of the latter.
  struct Way {
    int from, to;
    Eigen::Matrix3d information;
  };
  std::vector<keyframes::Inheritance> inherited;  ///< of each keyframe
  std::vector<Eigen::Matrix3d> noise;             ///< as keyframes::Keyframe has it
  std::vector<Way> steps;                         ///< odometry's edge to each; of the first: none, all zero
  std::vector<Way> loops;                         ///< with the share of their information that they tell
  double point_variance;                          ///< see keyframes::PointNoise::varianceOfPull()
};

/// Of a keyframe's error, map frame: how much of another's pose's error it is.
struct PoseShare {
  int keyframe;
  Eigen::Matrix3d of_pose;
};
/// Of one that inherits its error: of each view, in their order, and of the pose before. `step_from`: the
/// keyframe that odometry's edge is from.
std::vector<PoseShare> poseShares(const keyframes::Inheritance& from, const core::Pose2& T_map_keyframe,
                                  int step_from, const std::vector<core::Pose2>& poses);
/// What keyframe k's pose errs by, drawn: what it inherits of views' surfaces and of the pose before, and
/// what is new; or odometry's step alone. REQUIRES odometry's edge to it. `draw`: see
/// keyframes::ErrorSamples::addNew().
keyframes::ErrorSamples inheritedErrors(const keyframes::KeyframeMap& map, int k, std::uint64_t draw);
/// Covariance of what it takes over of the noise of a view's points. `view_points_err`: the view's own.
Eigen::Matrix3d noiseOfView(const keyframes::Inheritance& from, const keyframes::Inheritance::View& view,
                            double view_points_err, double point_variance);

}  // namespace slam::uncertainty
