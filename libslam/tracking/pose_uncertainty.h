#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/keyframes/keyframe_map.h"
#include "libslam/tracking/step_variance.h"
#include "libslam/tracking/tracker.h"
#include "libslam/uncertainty/inheriting.h"

namespace slam::tracking {

/// How sure the robot's pose is, from scan to scan; map frame, x, y (m), phi (rad). A scan errs against the
/// map by its points' noise, as their residuals tell it. The map does not lie better than the keyframes that
/// saw its surfaces first: errors grow from one view to the next that shares no surface with it, not from
/// keyframe to keyframe. Where a match leaves a direction open, odometry adds to the error before. For the
/// rooms of graph SLAM only.
class PoseUncertainty {
 public:
  /// `map` has to stay where it is.
  explicit PoseUncertainty(keyframes::KeyframeMap& map) : map_(&map) {}

  /// What a scan tells of its pose, and what all scans so far say of the points' noise.
  void noteEvidence(const std::vector<scanmatch::PatchPoint>& points, const core::Pose2& T_map_robot,
                    const scanmatch::SurfelMap& map);
  /// Carries all on to the scan at hand, of which the evidence is. The first keyframe lies where it lies;
  /// what it saw does not. `noise`: what the pose errs by against the map as it is, where the match alone
  /// does not tell (Tracker::Unskewed).
  void carryOn(const Expected& expected, const scanmatch::MatchResult& result,
               const std::optional<Eigen::Matrix3d>& noise = std::nullopt);
  /// What the pose errs by beyond that of the keyframe that it hangs on. Both were matched to a map, each
  /// with its own noise; but the first keyframe's pose is given, and what is matched to it errs by both
  /// views' noise.
  Eigen::Matrix3d sinceKeyframe(int keyframe) const;

  /// The robot is where it is told to be.
  void restart() { errors_ = {}, from_keyframe_.setZero(), inheriting_.begin(-1); }
  /// It is that of the newest keyframe: see uncertainty::inheritedErrors().
  void inherit(int keyframe);
  /// So it is since this keyframe's error was found anew.
  void restartFrom(int keyframe, const core::Pose2& T_map_robot);
  /// The robot's pose became a keyframe's, or another keyframe tells it now.
  void beginKeyframe(int keyframe) { from_keyframe_.setZero(), inheriting_.begin(keyframe); }
  void hangOnKeyframe() { from_keyframe_ += noise_; }
  /// Of a keyframe at the scan at hand.
  keyframes::Inheritance inheritance() const { return inheriting_.of(evidence_); }
  void setCovariance(const Eigen::Matrix3d& covariance);
  /// What the scan at hand was matched to is a place where the robot is not: odometry alone tells of its
  /// pose.
  void forgetViews() { evidence_.by_view.clear(), evidence_.beyond_slope.setZero(), inheriting_.begin(-1); }

  const scanmatch::MatchEvidence& evidence() const { return evidence_; }
  const keyframes::ErrorSamples& errors() const { return errors_; }  ///< of the pose in the map
  Eigen::Matrix3d covariance() const;                                ///< of the same
  const Eigen::Matrix3d& noise() const { return noise_; }            ///< of one scan: its match
  /// What the scan at hand tells of its pose, over x, y (m) and phi (rad), map axes.
  Eigen::Matrix3d toldInformation() const;

 private:
  keyframes::KeyframeMap* map_;
  scanmatch::MatchEvidence evidence_;
  StepVariance step_variance_;
  uncertainty::Inheriting inheriting_;
  keyframes::ErrorSamples errors_;
  std::uint64_t draws_ = 1;                                  ///< of errors; each has its number
  Eigen::Matrix3d from_keyframe_ = Eigen::Matrix3d::Zero();  ///< by odometry alone, since the keyframe
  Eigen::Matrix3d noise_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d beyond_ = Eigen::Matrix3d::Zero();  ///< of noise_: what the match alone does not tell
};

}  // namespace slam::tracking
