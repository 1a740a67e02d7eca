#include "libslam/uncertainty/relative_error.h"

#include "libslam/core/elementary.h"
#include "libslam/keyframes/matching.h"
#include "libslam/scanmatch/information.h"

namespace slam::uncertainty {
namespace {

/// Takes a turn about the origin, and a shift, into axes turned by phi: (x, y) is where the turn shows.
Eigen::Matrix3d moves(double x, double y, double phi) {
  const auto [s, c] = core::sinCos(phi);
  Eigen::Matrix3d J;
  J << c, s, x, -s, c, y, 0, 0, 1;
  return J;
}

}  // namespace

RelativeError::RelativeError(const keyframes::KeyframeMap& map, Poses poses)
    : map_(map), flow_(std::make_shared<const ErrorFlow>(map, poses)) {}

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
  if (a.keyframe != b.keyframe) {
    covariance += J * flow_->relative(a.keyframe, b.keyframe) * J.transpose();
  } else {
    // Each has its own match's noise, as large as the keyframe's.
    const Eigen::Matrix3d& noise = map_.keyframe(a.keyframe).noise;
    covariance += J_a * noise * J_a.transpose() + J_b * noise * J_b.transpose();
  }
  return scanmatch::withoutNegatives(covariance, keyframes::kLeastShare, 0);
}

}  // namespace slam::uncertainty
