#include "libslam/tracking/pose_uncertainty.h"

#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"
#include "libslam/scanmatch/information.h"
#include "libslam/uncertainty/error_sources.h"
#include "libslam/uncertainty/pose_error.h"

namespace slam::tracking {

using core::Pose2;

void PoseUncertainty::noteEvidence(const std::vector<scanmatch::PatchPoint>& points, const Pose2& T_map_robot,
                                   const scanmatch::SurfelMap& map) {
  evidence_ = evidenceOf(points, map, T_map_robot, keyframes::kKernel);
  map_->pointNoise().add(evidence_);
}

void PoseUncertainty::carryOn(const Expected& e, const scanmatch::MatchResult& result,
                              const std::optional<Eigen::Matrix3d>& noise) {
  const Pose2& T = result.T_map_robot;
  const Eigen::Matrix3d assumed =
      scanmatch::covarianceOf(scanmatch::poseInformation(e.step.sigma_xy_m, e.step.sigma_turn_rad));
  uncertainty::PoseError error = uncertainty::errorAfterMatch(*map_, evidence_, result.posterior_information);
  if (noise) raiseNoise(error, *noise);
  beyond_ = error.beyond;
  const Eigen::Matrix3d since = keyframes::moved(core::position(e.T_before), core::position(T));
  step_variance_.add(
      {T.x - e.predicted.x, T.y - e.predicted.y, core::angleDifference(T.phi, e.predicted.phi)},
      Eigen::Matrix3d::Identity() - error.stays, assumed, error.noise, noise_);
  const Eigen::Matrix3d odometry = step_variance_.of(assumed);
  noise_ = error.noise;
  noteFirst(*map_, error);
  errors_ = errorsAfterMatch(*map_, evidence_, error, T, {e.T_before, errors_, odometry}, draws_++);
  from_keyframe_ = scanmatch::withoutNegatives(
      error.stays * (since * from_keyframe_ * since.transpose() + odometry) * error.stays.transpose(),
      keyframes::kLeastShare, 0);
  inheriting_.carryOn(error, since, odometry);
}

Eigen::Matrix3d PoseUncertainty::covariance() const {
  return scanmatch::withoutNegatives(errors_.covariance(), keyframes::kLeastShare, 0);
}

void PoseUncertainty::setCovariance(const Eigen::Matrix3d& covariance) {
  errors_.clear();
  errors_.addNew(covariance, draws_++);
}

void PoseUncertainty::inherit(int keyframe) {
  errors_ = uncertainty::inheritedErrors(*map_, keyframe, draws_++);
}

void PoseUncertainty::restartFrom(int keyframe, const Pose2& T_map_robot) {
  errors_.clear();
  errors_.add(keyframes::moved(core::position(map_->pose(keyframe)), core::position(T_map_robot)),
              map_->errorsOf(keyframe));
  errors_.addNew(sinceKeyframe(keyframe), draws_++);
}

Eigen::Matrix3d PoseUncertainty::toldInformation() const {
  const Eigen::Matrix3d told = keyframes::toldInformation(evidence_);
  return beyond_.isZero() ? told : scanmatch::covarianceOf(scanmatch::covarianceOf(told) + beyond_);
}

Eigen::Matrix3d PoseUncertainty::sinceKeyframe(int keyframe) const {
  return keyframe == 0 ? from_keyframe_ + keyframes::kBothViews * noise_ : from_keyframe_;
}

}  // namespace slam::tracking
