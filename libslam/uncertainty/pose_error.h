#pragma once
#include <Eigen/Core>

#include "libslam/core/pose2.h"
#include "libslam/keyframes/keyframe_map.h"
#include "libslam/scanmatch/surfel_matcher.h"

namespace slam::uncertainty {

/// What is known of the robot's pose before a match, and of the way from there; map frame.
struct Before {
  core::Pose2 T_map_robot;
  Eigen::Matrix3d covariance;
  Eigen::Matrix3d odometry;  ///< covariance of the step since, as odometry has it
};

/// What a matched pose errs by; map frame.
struct PoseError {
  Eigen::Matrix3d noise;       ///< against the map as it was
  Eigen::Matrix3d beyond;      ///< of that, what the match alone does not tell
  Eigen::Matrix3d covariance;  ///< in the map
  Eigen::Matrix3d least;       ///< one match, and odometry where that leaves directions open
  Eigen::Matrix3d stays;       ///< how much of an error before is left
  Eigen::Matrix3d gain;        ///< times the information of a view: how much of its error is taken over
};

/// The matched pose is a mean of what the map and odometry say, with the weights that matching gave them: its
/// error is that mean of their errors. Errors of views that share a past are taken as wholly correlated.
/// While the map has one keyframe, what that saw errs by the match's noise, too. For the rooms of graph SLAM
/// only.
PoseError errorAfterMatch(const keyframes::KeyframeMap& map, const scanmatch::MatchEvidence& evidence,
                          const Eigen::Matrix3d& posterior_information, const core::Pose2& T_map_robot,
                          const Before& before);

/// Where the pose errs by `noise` against the map as it was, in whatever direction the match alone tells
/// less: of a spinning lidar, of which it is not known exactly how it moved in its sweep.
void raiseNoise(PoseError& error, const Eigen::Matrix3d& noise);

/// From where the newest keyframe's pose is known, and how well: by what its covariance has grown since, and
/// no better than `least`, what one match tells.
void noteMatch(keyframes::KeyframeMap& map, const scanmatch::MatchEvidence& evidence,
               const Eigen::Matrix3d& least);

}  // namespace slam::uncertainty
