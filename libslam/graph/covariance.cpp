#include "libslam/graph/graph_slam.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/pose_error.h"
#include "libslam/keyframes/search.h"

/// How sure GraphSlam is of its poses. A scan errs against the map by its points' noise, as their residuals
/// tell it. The map does not lie better than the keyframes that saw its surfaces first: errors grow from one
/// view to the next that shares no surface with it, not from keyframe to keyframe. Where a match leaves a
/// direction open, odometry adds to the error before.
namespace slam::graph {

using core::Pose2;

/// What a scan tells of its pose, and what all scans so far say of the points' noise.
void GraphSlam::noteEvidence(const std::vector<scanmatch::PatchPoint>& points, const Pose2& T_map_robot,
                             const scanmatch::SurfelMap& map) {
  evidence_ = evidenceOf(points, map, T_map_robot, keyframes::kKernel);
  map_->pointNoise().add(evidence_);
}

/// Carries the covariance on to the scan at hand.
void GraphSlam::estimateCovariance(const keyframes::Expected& e, const scanmatch::MatchResult& result) {
  const Eigen::Matrix3d Q =
      scanmatch::covarianceOf(scanmatch::poseInformation(e.step.sigma_xy_m, e.step.sigma_turn_rad));
  const keyframes::PoseError error = keyframes::errorAfterMatch(
      *map_, evidence_, result.posterior_information, result.T_map_robot, {e.T_before, covariance_, Q});
  noise_ = error.noise, least_ = error.least, covariance_ = error.covariance;
  // The first keyframe lies where it lies; what it saw does not.
  if (map_->keyframes().size() == 1) map_->keyframes()[0].root = scanmatch::rootOf(noise_);
  const Eigen::Matrix3d since =
      keyframes::moved(core::position(e.T_before), core::position(result.T_map_robot));
  from_keyframe_ = scanmatch::withoutNegatives(
      error.stays * (since * from_keyframe_ * since.transpose() + Q) * error.stays.transpose(),
      keyframes::kLeastShare, 0);
}

/// What a scan's pose errs by beyond its keyframe's. Both were matched to a map, each with its own noise; but
/// the first keyframe's pose is given, and what is matched to it errs by both views' noise.
Eigen::Matrix3d GraphSlam::driftSinceKeyframe() const {
  return anchor_ == 0 ? from_keyframe_ + keyframes::kBothViews * noise_ : from_keyframe_;
}

std::vector<Eigen::Matrix3d> GraphSlam::covariances() const {
  std::vector<Eigen::Matrix3d> result;
  if (records_.empty()) return result;
  const auto keyframes = map_->keyframeCovariances();
  result.reserve(records_.size());
  for (const auto& record : records_) {
    const Pose2& T_map_keyframe = map_->pose(record.keyframe);
    const Eigen::Matrix3d J = keyframes::moved(core::position(T_map_keyframe),
                                               core::position(T_map_keyframe * record.T_keyframe_robot));
    result.push_back(J * keyframes[static_cast<size_t>(record.keyframe)] * J.transpose() +
                     record.drift_covariance.matrix());
  }
  return result;
}

std::vector<Eigen::Matrix3d> GraphSlam::relativeCovariances(
    const std::vector<std::pair<int, int>>& scans) const {
  std::vector<Eigen::Matrix3d> result;
  if (scans.empty()) return result;
  const keyframes::RelativeError error(*map_);
  const auto hung = [&](int scan) -> keyframes::HungScan {
    const auto& record = records_[static_cast<size_t>(scan)];
    return {record.keyframe, record.T_keyframe_robot, record.drift_covariance.matrix()};
  };
  result.reserve(scans.size());
  for (const auto& [first, second] : scans) result.push_back(error.covariance(hung(first), hung(second)));
  return result;
}

}  // namespace slam::graph
