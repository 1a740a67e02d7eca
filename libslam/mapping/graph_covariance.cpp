#include "libslam/mapping/graph_slam.h"
#include "libslam/posegraph/marginals.h"

namespace slam::mapping {
namespace {

using core::Point2;
using core::Pose2;

/// Errors of matches that share a map are not independent, as the graph takes them to be. This and kMatchCovarianceScale
/// make the poses' mean normalised squared error about 1 over 56 simulated runs in rooms and corridors;
/// benchmarks/results/consistency.csv.xz has other runs than those.
constexpr double kGraphCovarianceScale = 3;
/// Of a covariance's eigenvalues, against the largest: below, they are rounding.
constexpr double kLeastShare = 1e-15;

/// Of a pose at `from`, as one that is firmly joined to it and lies at `to` has it; map frame.
Eigen::Matrix3d movedCovariance(const Eigen::Matrix3d& covariance, const Point2& from, const Point2& to) {
  Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
  J(0, 2) = from.y - to.y, J(1, 2) = to.x - from.x;
  return J * covariance * J.transpose();
}

}  // namespace

/// Of the local map's place in the map, as a pose at a point has it from there: what the keyframes that share a match have
/// in common, for they have been found from one another.
Eigen::Matrix3d GraphSlam::mapCovariance(const Point2& at) const {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const int k : anchors_)
    sum += movedCovariance(keyframe(k).covariance, core::position(graph_.pose(k)), at);
  return anchors_.empty() ? sum : Eigen::Matrix3d(sum / static_cast<double>(anchors_.size()));
}

std::vector<Eigen::Matrix3d> GraphSlam::keyframeCovariances() const {
  // Leaps of odometry may leave a pose held by no more than rounding.
  auto covariances = posegraph::Marginals(graph_, posegraph::Marginals::Open::kBounded).all();
  for (auto& covariance : covariances)
    covariance = withoutNegatives(kGraphCovarianceScale * covariance, kLeastShare, 0);
  return covariances;
}

std::vector<Eigen::Matrix3d> GraphSlam::covariances() const {
  std::vector<Eigen::Matrix3d> result;
  if (records_.empty()) return result;
  const auto keyframes = keyframeCovariances();
  result.reserve(records_.size());
  for (const auto& record : records_) {
    const Pose2& T_map_keyframe = graph_.pose(record.keyframe);
    result.push_back(movedCovariance(keyframes[static_cast<size_t>(record.keyframe)],
                                     core::position(T_map_keyframe),
                                     core::position(T_map_keyframe * record.T_keyframe_robot)) +
                     kGraphCovarianceScale / kMatchCovarianceScale * record.match_covariance);
  }
  return result;
}

}  // namespace slam::mapping
