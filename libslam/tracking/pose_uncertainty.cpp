#include "libslam/tracking/pose_uncertainty.h"

#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/pose_error.h"
#include "libslam/keyframes/search.h"
#include "libslam/scanmatch/information.h"

namespace slam::tracking {

using core::Pose2;

void PoseUncertainty::noteEvidence(const std::vector<scanmatch::PatchPoint>& points, const Pose2& T_map_robot,
                                   const scanmatch::SurfelMap& map) {
  evidence_ = evidenceOf(points, map, T_map_robot, keyframes::kKernel);
  map_->pointNoise().add(evidence_);
}

void PoseUncertainty::carryOn(const Expected& e, const scanmatch::MatchResult& result,
                              const std::optional<Eigen::Matrix3d>& noise) {
  const Eigen::Matrix3d Q =
      scanmatch::covarianceOf(scanmatch::poseInformation(e.step.sigma_xy_m, e.step.sigma_turn_rad));
  const keyframes::PoseError error = keyframes::errorAfterMatch(
      *map_, evidence_, result.posterior_information, result.T_map_robot, {e.T_before, covariance_, Q});
  noise_ = error.noise, least_ = error.least, covariance_ = error.covariance;
  beyond_.setZero();
  if (noise) {
    beyond_ = scanmatch::withoutNegatives(*noise - error.noise, 0, 0);
    noise_ += beyond_, least_ += beyond_, covariance_ += beyond_;
  }
  if (map_->keyframes().size() == 1) map_->keyframes()[0].root = scanmatch::rootOf(noise_);
  const Eigen::Matrix3d since =
      keyframes::moved(core::position(e.T_before), core::position(result.T_map_robot));
  from_keyframe_ = scanmatch::withoutNegatives(
      error.stays * (since * from_keyframe_ * since.transpose() + Q) * error.stays.transpose(),
      keyframes::kLeastShare, 0);
}

Eigen::Matrix3d PoseUncertainty::toldInformation() const {
  const Eigen::Matrix3d told = keyframes::toldInformation(evidence_);
  return beyond_.isZero() ? told : scanmatch::covarianceOf(scanmatch::covarianceOf(told) + beyond_);
}

Eigen::Matrix3d PoseUncertainty::sinceKeyframe(int keyframe) const {
  return keyframe == 0 ? from_keyframe_ + keyframes::kBothViews * noise_ : from_keyframe_;
}

}  // namespace slam::tracking
