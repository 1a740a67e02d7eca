#include "libslam/uncertainty/pose_error.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>

#include "libslam/keyframes/matching.h"
#include "libslam/scanmatch/information.h"

namespace slam::uncertainty {

using keyframes::Keyframe;
using keyframes::KeyframeMap;
using keyframes::kLeastShare;
using keyframes::moved;

namespace {

/// The covariance, but in no direction less than the other one, which is positive definite.
Eigen::Matrix3d atLeast(const Eigen::Matrix3d& covariance, const Eigen::Matrix3d& least) {
  const Eigen::Matrix3d L = Eigen::LLT<Eigen::Matrix3d>(least).matrixL();
  const Eigen::Matrix3d inverse = L.inverse();
  return L * scanmatch::withoutNegatives(inverse * covariance * inverse.transpose(), 0, 1) * L.transpose();
}

}  // namespace

PoseError errorAfterMatch(const KeyframeMap& map, const scanmatch::MatchEvidence& evidence,
                          const Eigen::Matrix3d& posterior_information, const core::Pose2& T_map_robot,
                          const Before& before) {
  const core::Point2 here = core::position(T_map_robot);
  const double scale = keyframes::matchOptions(1).information_scale;
  const Eigen::Matrix3d S = scale * scanmatch::covarianceOf(posterior_information);
  const Eigen::Matrix3d H = evidence.information();
  PoseError error;
  error.gain = S;
  error.beyond.setZero();
  error.noise = scanmatch::withoutNegatives(map.pointNoise().variance() * S * H * S, 0, 0);
  const bool is_of_first = map.size() == 1;
  Eigen::Matrix3d root = Eigen::Matrix3d::Zero();
  for (const auto& view : evidence.by_view)
    root += S * view.information * moved(core::position(map.pose(view.view)), here) *
            (is_of_first ? scanmatch::rootOf(error.noise) : map.keyframe(view.view).root);
  error.stays = Eigen::Matrix3d::Identity() - S * H;
  const Eigen::Matrix3d since = moved(core::position(before.T_map_robot), here);
  root += error.stays * since * scanmatch::rootOf(before.covariance);
  error.least = error.noise + error.stays * before.odometry * error.stays.transpose();
  error.covariance = scanmatch::withoutNegatives(root * root.transpose() + error.least, kLeastShare, 0);
  return error;
}

void raiseNoise(PoseError& error, const Eigen::Matrix3d& noise) {
  error.beyond = scanmatch::withoutNegatives(noise - error.noise, 0, 0);
  error.noise += error.beyond, error.least += error.beyond, error.covariance += error.beyond;
}

void noteMatch(KeyframeMap& map, const scanmatch::MatchEvidence& evidence, const Eigen::Matrix3d& least) {
  Keyframe& newest = map.keyframes().back();
  const auto& views = evidence.by_view;
  if (views.empty()) return;
  const auto ofPosition = [](const scanmatch::ViewInformation& view) {
    return view.information(0, 0) + view.information(1, 1);
  };
  const auto most = std::max_element(views.begin(), views.end(), [&](const auto& a, const auto& b) {
    return ofPosition(a) < ofPosition(b);
  });
  const Keyframe& first = map.keyframe(most->view);
  const core::Pose2& T = map.pose(map.lastKeyframe());
  const Eigen::Matrix3d J = moved(core::position(map.pose(most->view)), core::position(T));
  const Eigen::Matrix3d grown = newest.covariance - J * first.covariance * J.transpose();
  newest.matched_to = most->view;
  newest.information = scanmatch::turned(scanmatch::covarianceOf(atLeast(grown, least)), T.phi);
}

}  // namespace slam::uncertainty
