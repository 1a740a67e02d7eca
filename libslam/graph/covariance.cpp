#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>

#include "libslam/graph/graph_slam.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"

/// How sure GraphSlam is of its poses. A scan errs against the map by its points' noise, as their residuals
/// tell it. The map does not lie better than the keyframes that saw its surfaces first: errors grow from one
/// view to the next that shares no surface with it, not from keyframe to keyframe. Where a match leaves a
/// direction open, odometry adds to the error before.
namespace slam::graph {
namespace {

using core::Point2;
using core::Pose2;

/// The covariance, but in no direction less than the other one, which is positive definite.
Eigen::Matrix3d atLeast(const Eigen::Matrix3d& covariance, const Eigen::Matrix3d& least) {
  const Eigen::Matrix3d L = Eigen::LLT<Eigen::Matrix3d>(least).matrixL();
  const Eigen::Matrix3d inverse = L.inverse();
  return L * scanmatch::withoutNegatives(inverse * covariance * inverse.transpose(), 0, 1) * L.transpose();
}

}  // namespace

/// What a scan tells of its pose, and what all scans so far say of the points' noise.
void GraphSlam::noteEvidence(const std::vector<scanmatch::PatchPoint>& points, const Pose2& T_map_robot,
                             const scanmatch::SurfelMap& map) {
  evidence_ = evidenceOf(points, map, T_map_robot, keyframes::kKernel);
  map_->pointNoise().add(evidence_);
}

/// Carries the covariance on to the scan at hand. The matched pose is a mean of what the map and odometry
/// say, with the weights that matching gave them: its error is that mean of their errors. Errors of views
/// that share a past are taken as wholly correlated.
void GraphSlam::estimateCovariance(const keyframes::Expected& e, const scanmatch::MatchResult& result) {
  const Point2 here = core::position(result.T_map_robot);
  const double scale = keyframes::matchOptions(1).information_scale;
  const Eigen::Matrix3d S = scale * scanmatch::covarianceOf(result.posterior_information);
  const Eigen::Matrix3d H = evidence_.information();
  noise_ = scanmatch::withoutNegatives(map_->pointNoise().variance() * S * H * S, 0, 0);
  Eigen::Matrix3d root = Eigen::Matrix3d::Zero();
  // The first keyframe lies where it lies; what it saw does not.
  if (map_->keyframes().size() == 1) map_->keyframes()[0].root = scanmatch::rootOf(noise_);
  for (const auto& view : evidence_.by_view)
    root += S * view.information * keyframes::moved(core::position(map_->pose(view.view)), here) *
            map_->keyframe(view.view).root;
  const Eigen::Matrix3d stays = Eigen::Matrix3d::Identity() - S * H;
  const Eigen::Matrix3d since = keyframes::moved(core::position(e.T_before), here);
  const Eigen::Matrix3d Q =
      scanmatch::covarianceOf(scanmatch::poseInformation(e.step.sigma_xy_m, e.step.sigma_turn_rad));
  root += stays * since * scanmatch::rootOf(covariance_);
  least_ = noise_ + stays * Q * stays.transpose();
  covariance_ = scanmatch::withoutNegatives(root * root.transpose() + least_, keyframes::kLeastShare, 0);
  from_keyframe_ = scanmatch::withoutNegatives(
      stays * (since * from_keyframe_ * since.transpose() + Q) * stays.transpose(), keyframes::kLeastShare,
      0);
}

/// What a scan's pose errs by beyond its keyframe's. Both were matched to a map, each with its own noise; but
/// the first keyframe's pose is given, and what is matched to it errs by both views' noise.
Eigen::Matrix3d GraphSlam::driftSinceKeyframe() const {
  return anchor_ == 0 ? from_keyframe_ + keyframes::kBothViews * noise_ : from_keyframe_;
}

/// From where the newest keyframe's pose is known, and how well: by what its covariance has grown since, and
/// no better than one match tells.
void GraphSlam::noteMatch() {
  keyframes::Keyframe& newest = map_->keyframes().back();
  const auto& views = evidence_.by_view;
  if (views.empty()) return;
  const auto ofPosition = [](const scanmatch::ViewInformation& view) {
    return view.information(0, 0) + view.information(1, 1);
  };
  const auto most = std::max_element(views.begin(), views.end(), [&](const auto& a, const auto& b) {
    return ofPosition(a) < ofPosition(b);
  });
  const keyframes::Keyframe& first = map_->keyframe(most->view);
  const Pose2& T = map_->pose(map_->lastKeyframe());
  const Eigen::Matrix3d J = keyframes::moved(core::position(map_->pose(most->view)), core::position(T));
  const Eigen::Matrix3d grown = newest.covariance - J * first.covariance * J.transpose();
  newest.matched_to = most->view;
  newest.information = scanmatch::turned(scanmatch::covarianceOf(atLeast(grown, least_)), T.phi);
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
                     record.drift_covariance);
  }
  return result;
}

}  // namespace slam::graph
