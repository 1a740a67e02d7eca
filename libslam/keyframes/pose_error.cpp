#include "libslam/keyframes/pose_error.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>

#include "libslam/core/elementary.h"
#include "libslam/keyframes/matching.h"
#include "libslam/posegraph/marginals.h"
#include "libslam/scanmatch/information.h"

namespace slam::keyframes {
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
  const double scale = matchOptions(1).information_scale;
  const Eigen::Matrix3d S = scale * scanmatch::covarianceOf(posterior_information);
  const Eigen::Matrix3d H = evidence.information();
  PoseError error;
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

namespace {

/// Takes a turn about the origin, and a shift, into axes turned by phi: (x, y) is where the turn shows.
Eigen::Matrix3d moves(double x, double y, double phi) {
  const auto [s, c] = core::sinCos(phi);
  Eigen::Matrix3d J;
  J << c, s, x, -s, c, y, 0, 0, 1;
  return J;
}

}  // namespace

RelativeError::RelativeError(const KeyframeMap& map)
    : map_(map),
      keyframes_(std::make_shared<posegraph::Marginals>(
          witnessGraph(map.graph(), map.graph().poses(), map.witnesses()),
          posegraph::Marginals::Open::kBounded)) {}

Eigen::Matrix3d RelativeError::covariance(const HungScan& a, const HungScan& b) const {
  const core::Pose2 T_map_a = map_.pose(a.keyframe) * a.T_keyframe_robot,
                    T_map_b = map_.pose(b.keyframe) * b.T_keyframe_robot,
                    T_a_b = core::between(T_map_a, T_map_b);
  // A turn of the first keyframe's view of the second carries b with it.
  const core::Pose2 T_keyframes = core::between(map_.pose(a.keyframe), map_.pose(b.keyframe));
  const auto [s, c] = core::sinCos(core::wrapToPi(T_keyframes.phi - a.T_keyframe_robot.phi));
  const double x = c * b.T_keyframe_robot.x - s * b.T_keyframe_robot.y,
               y = s * b.T_keyframe_robot.x + c * b.T_keyframe_robot.y;
  const Eigen::Matrix3d J = moves(-y, x, a.T_keyframe_robot.phi), J_b = moves(0, 0, T_map_a.phi),
                        J_a = moves(-T_a_b.y, T_a_b.x, T_map_a.phi);
  Eigen::Matrix3d covariance =
      J_a * a.drift_covariance * J_a.transpose() + J_b * b.drift_covariance * J_b.transpose();
  if (a.keyframe != b.keyframe)
    covariance += J * keyframes_->relative(a.keyframe, b.keyframe) * J.transpose();
  return scanmatch::withoutNegatives(covariance, kLeastShare, 0);
}

}  // namespace slam::keyframes
