#pragma once
#include <Eigen/Core>
#include <cstdint>

#include "libslam/core/pose2.h"
#include "libslam/keyframes/keyframe_map.h"
#include "libslam/scanmatch/surfel_matcher.h"

namespace slam::uncertainty {

/// What a matched pose errs by, besides what others err by; map frame.
struct PoseError {
  Eigen::Matrix3d noise;   ///< against the map as it was
  Eigen::Matrix3d beyond;  ///< of that, what the match alone does not tell
  Eigen::Matrix3d stays;   ///< how much of an error before is left
  Eigen::Matrix3d gain;    ///< times the information of a view: how much of its error is taken over
};

/// The matched pose is a mean of what the map and odometry say, with the weights that matching gave them: its
/// error is that mean of their errors. For the rooms of graph SLAM only.
PoseError errorAfterMatch(const keyframes::KeyframeMap& map, const scanmatch::MatchEvidence& evidence,
                          const Eigen::Matrix3d& posterior_information);

/// Where the pose errs by `noise` against the map as it was, in whatever direction the match alone tells
/// less: of a spinning lidar, of which it is not known exactly how it moved in its sweep.
void raiseNoise(PoseError& error, const Eigen::Matrix3d& noise);

/// While a map has one keyframe, what that saw errs by as much as a match to it: it lies where it lies.
void noteFirst(keyframes::KeyframeMap& map, const PoseError& error);

/// A pose whose error is followed, and how far odometry may err on the step from there: covariance, map
/// frame.
struct Followed {
  core::Pose2 T_map_robot;
  keyframes::ErrorSamples errors;
  Eigen::Matrix3d odometry;
};
/// What the matched pose errs by, drawn: what the surfaces of its views err by, what is left of the error
/// before and of odometry's, and the match's noise. `draw`: see keyframes::ErrorSamples::addNew().
keyframes::ErrorSamples errorsAfterMatch(const keyframes::KeyframeMap& map,
                                         const scanmatch::MatchEvidence& evidence, const PoseError& error,
                                         const core::Pose2& T_map_robot, const Followed& before,
                                         std::uint64_t draw);

}  // namespace slam::uncertainty
