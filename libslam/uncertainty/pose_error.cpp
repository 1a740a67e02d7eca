#include "libslam/uncertainty/pose_error.h"

#include <Eigen/Cholesky>

#include "libslam/keyframes/matching.h"
#include "libslam/scanmatch/information.h"

namespace slam::uncertainty {

using keyframes::KeyframeMap;
using keyframes::moved;

namespace {

/// What really holds a matched pose: the slope of the robust pulls, and the prior. Where that is less than a
/// tenth of what weights say, the match had not come to rest, and its weights count.
Eigen::Matrix3d heldBy(const Eigen::Matrix3d& posterior_information,
                       const scanmatch::MatchEvidence& evidence) {
  constexpr double kLeast = 0.1;
  const Eigen::Matrix3d held =
      posterior_information - keyframes::matchOptions(1).information_scale * evidence.beyond_slope;
  const Eigen::Matrix3d enough = held - kLeast * posterior_information;
  return enough.llt().info() == Eigen::Success ? held : posterior_information;
}

}  // namespace

PoseError errorAfterMatch(const KeyframeMap& map, const scanmatch::MatchEvidence& evidence,
                          const Eigen::Matrix3d& posterior_information) {
  const double scale = keyframes::matchOptions(1).information_scale;
  const Eigen::Matrix3d S = scale * scanmatch::covarianceOf(heldBy(posterior_information, evidence));
  PoseError error;
  error.gain = S;
  error.beyond.setZero();
  error.noise =
      scanmatch::withoutNegatives(map.pointNoise().varianceOfPull() * S * evidence.information() * S, 0, 0);
  error.stays = Eigen::Matrix3d::Identity() - S * evidence.slope();
  return error;
}

void raiseNoise(PoseError& error, const Eigen::Matrix3d& noise) {
  error.beyond = scanmatch::withoutNegatives(noise - error.noise, 0, 0);
  error.noise += error.beyond;
}

void noteFirst(KeyframeMap& map, const PoseError& error) {
  if (map.size() != 1) return;
  map.keyframes()[0].noise = error.noise;
  map.setErrors(0, {});
}

keyframes::ErrorSamples errorsAfterMatch(const KeyframeMap& map, const scanmatch::MatchEvidence& evidence,
                                         const PoseError& error, const core::Pose2& T_map_robot,
                                         const Followed& before, std::uint64_t draw) {
  const core::Point2 here = core::position(T_map_robot);
  keyframes::ErrorSamples result;
  for (const auto& view : evidence.by_view)
    result.add(error.gain * view.information * moved(core::position(map.pose(view.view)), here),
               map.keyframe(view.view).surfaces);
  result.add(error.stays * moved(core::position(before.T_map_robot), here), before.errors);
  result.addNew(error.noise + error.stays * before.odometry * error.stays.transpose(), draw);
  return result;
}

}  // namespace slam::uncertainty
