#include "libslam/uncertainty/error_sources.h"

#include "libslam/core/pose2.h"
#include "libslam/scanmatch/information.h"

namespace slam::uncertainty {

using core::position;
using Eigen::Matrix3d;

ErrorSources::ErrorSources(const keyframes::KeyframeMap& map)
    : point_variance(map.pointNoise().varianceOfPull()) {
  const auto& edges = map.graph().edges();
  const auto count = static_cast<size_t>(map.size());
  inherited.reserve(count), noise.reserve(count), steps.reserve(count);
  for (const auto& keyframe : map.keyframes()) {
    inherited.push_back(keyframe.inherited), noise.push_back(keyframe.noise);
    if (steps.empty()) {
      steps.push_back({0, 0, Matrix3d::Zero()});
      continue;
    }
    const posegraph::Edge& step = edges[static_cast<size_t>(keyframe.odometry_edge)];
    steps.push_back({step.from, step.to, step.information});
  }
  for (const keyframes::LoopEdge& one : map.loopEdges()) {
    const posegraph::Edge& edge = edges[one.edge];
    loops.push_back({edge.from, edge.to, one.share * edge.information});
  }
}

std::vector<PoseShare> poseShares(const keyframes::Inheritance& from, const core::Pose2& T_map_keyframe,
                                  int step_from, const std::vector<core::Pose2>& poses) {
  const auto moves = [&](int k) {
    return keyframes::moved(position(poses[static_cast<size_t>(k)]), position(T_map_keyframe));
  };
  std::vector<PoseShare> result;
  const bool is_by_odometry = from.own.isZero();
  Matrix3d left = Matrix3d::Identity();
  for (const auto& view : from.views) {
    if (is_by_odometry) break;
    const Matrix3d share = from.gain * view.information.matrix();
    left -= share;
    result.push_back({view.keyframe, share * moves(view.keyframe)});
  }
  const int before = is_by_odometry || from.before < 0 ? step_from : from.before;
  result.push_back({before, left * moves(before)});
  return result;
}

keyframes::ErrorSamples inheritedErrors(const keyframes::KeyframeMap& map, int k, std::uint64_t draw) {
  const keyframes::Keyframe& keyframe = map.keyframe(k);
  const posegraph::Edge& step = map.graph().edges()[static_cast<size_t>(keyframe.odometry_edge)];
  const std::vector<PoseShare> shares =
      poseShares(keyframe.inherited, map.pose(k), step.from, map.graph().poses());
  keyframes::ErrorSamples result;
  for (size_t i = 0; i + 1 < shares.size(); ++i)
    result.add(shares[i].of_pose, map.keyframe(shares[i].keyframe).surfaces);
  result.add(shares.back().of_pose, map.errorsOf(shares.back().keyframe));
  result.addNew(keyframe.inherited.own.isZero()
                    ? scanmatch::covarianceOf(scanmatch::turned(step.information, -map.pose(k).phi))
                    : keyframe.inherited.own.matrix(),
                draw);
  return result;
}

Matrix3d noiseOfView(const keyframes::Inheritance& from, const keyframes::Inheritance::View& view,
                     double view_points_err, double point_variance) {
  return point_variance * view_points_err * view_points_err * from.gain * view.information.matrix() *
         from.gain.transpose();
}

}  // namespace slam::uncertainty
