#include "libslam/core/elementary.h"
#include "libslam/graph/graph_slam.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/pose_error.h"
#include "libslam/keyframes/search.h"
#include "libslam/posegraph/marginals.h"

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

/// By the keyframes that the two scans hang on, each with its drift since.
std::vector<Eigen::Matrix3d> GraphSlam::relativeCovariances(
    const std::vector<std::pair<int, int>>& scans) const {
  std::vector<Eigen::Matrix3d> result;
  if (scans.empty()) return result;
  const posegraph::Marginals keyframes(
      keyframes::witnessGraph(map_->graph(), map_->graph().poses(), map_->witnesses()),
      posegraph::Marginals::Open::kBounded);
  result.reserve(scans.size());
  const auto moves = [](double x, double y, double phi) {
    const auto [s, c] = core::sinCos(phi);
    Eigen::Matrix3d J;
    J << c, s, x, -s, c, y, 0, 0, 1;
    return J;
  };
  for (const auto& [first, second] : scans) {
    const auto &a = records_[static_cast<size_t>(first)], &b = records_[static_cast<size_t>(second)];
    const Pose2 T_map_a = map_->pose(a.keyframe) * a.T_keyframe_robot,
                T_map_b = map_->pose(b.keyframe) * b.T_keyframe_robot,
                T_a_b = core::between(T_map_a, T_map_b);
    // A turn of the first keyframe's view of the second carries b with it.
    const Pose2 T_keyframes = core::between(map_->pose(a.keyframe), map_->pose(b.keyframe));
    const auto [s, c] = core::sinCos(core::wrapToPi(T_keyframes.phi - a.T_keyframe_robot.phi));
    const double x = c * b.T_keyframe_robot.x - s * b.T_keyframe_robot.y,
                 y = s * b.T_keyframe_robot.x + c * b.T_keyframe_robot.y;
    const Eigen::Matrix3d J = moves(-y, x, a.T_keyframe_robot.phi), J_b = moves(0, 0, T_map_a.phi),
                          J_a = moves(-T_a_b.y, T_a_b.x, T_map_a.phi);
    Eigen::Matrix3d covariance = J_a * a.drift_covariance.matrix() * J_a.transpose() +
                                 J_b * b.drift_covariance.matrix() * J_b.transpose();
    if (a.keyframe != b.keyframe)
      covariance += J * keyframes.relative(a.keyframe, b.keyframe) * J.transpose();
    result.push_back(scanmatch::withoutNegatives(covariance, keyframes::kLeastShare, 0));
  }
  return result;
}

}  // namespace slam::graph
