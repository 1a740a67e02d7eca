#include "libslam/graph/graph_slam.h"
#include "libslam/keyframes/matching.h"
#include "libslam/uncertainty/error_flow.h"
#include "libslam/uncertainty/relative_error.h"

/// How sure GraphSlam is of its poses in the end. From scan to scan: tracking::PoseUncertainty.
namespace slam::graph {

using core::Pose2;

namespace {

uncertainty::Poses posesThat(bool are_fitted) {
  return are_fitted ? uncertainty::Poses::kFitted : uncertainty::Poses::kTracked;
}

}  // namespace

std::vector<Eigen::Matrix3d> GraphSlam::covariances() const {
  std::vector<Eigen::Matrix3d> result;
  if (records_.empty()) return result;
  const auto keyframes = uncertainty::ErrorFlow(*map_, posesThat(isRefined())).covariances();
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
  const uncertainty::RelativeError error(*map_, posesThat(isRefined()));
  const auto hung = [&](int scan) -> uncertainty::HungScan {
    const auto& record = records_[static_cast<size_t>(scan)];
    return {record.keyframe, record.T_keyframe_robot, record.drift_covariance.matrix()};
  };
  result.reserve(scans.size());
  for (const auto& [first, second] : scans) result.push_back(error.covariance(hung(first), hung(second)));
  return result;
}

}  // namespace slam::graph
