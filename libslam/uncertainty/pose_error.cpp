#include "libslam/uncertainty/pose_error.h"

#include "libslam/keyframes/matching.h"
#include "libslam/scanmatch/information.h"

namespace slam::uncertainty {

using keyframes::KeyframeMap;
using keyframes::moved;

PoseError errorAfterMatch(const KeyframeMap& map, const scanmatch::MatchEvidence& evidence,
                          const Eigen::Matrix3d& posterior_information) {
  const double scale = keyframes::matchOptions(1).information_scale;
  const Eigen::Matrix3d S = scale * scanmatch::covarianceOf(posterior_information);
  const Eigen::Matrix3d H = evidence.information();
  PoseError error;
  error.gain = S;
  error.beyond.setZero();
  error.noise = scanmatch::withoutNegatives(map.pointNoise().variance() * S * H * S, 0, 0);
  error.stays = Eigen::Matrix3d::Identity() - S * H;
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
