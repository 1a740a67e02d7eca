#pragma once
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "libslam/keyframes/keyframe_map.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/settling.h"

/// Maps of a few keyframes, put where a test wants them.
namespace slam::keyframes::test_maps {

/// Beams of one length all the way round: a lidar in the middle of a round room.
inline lidar::Scan roundRoom(double radius_m, int beams = 360) {
  lidar::Scan scan;
  scan.first_angle_rad = -core::kPi;
  scan.step_rad = 2 * core::kPi / beams;
  scan.max_range_m = 20;
  scan.ranges_m.assign(static_cast<size_t>(beams), static_cast<float>(radius_m));
  return scan;
}

inline scanmatch::PatchPoint pointAt(double x, double y) {
  return {static_cast<float>(x), static_cast<float>(y), 0.01F, 0};
}

inline Eigen::Matrix3d diagonal(double x, double y, double phi) {
  return Eigen::Vector3d(x, y, phi).asDiagonal();
}

/// A keyframe there, which has driven so far and was reached from `before`; -1: it begins the map.
inline int addKeyframe(KeyframeMap& map, const core::Pose2& T_map_robot, const lidar::Scan& seen,
                       double path_m, int before) {
  Keyframe keyframe{};
  keyframe.scan = 10 * map.size();
  keyframe.seen = seen;
  keyframe.points = pointsOf(seen, map.options());
  keyframe.path_m = path_m;
  keyframe.odometry_edge = -1;
  keyframe.information = keyframe.noise = keyframe.covariance = keyframe.root = Eigen::Matrix3d::Zero();
  const int k = map.graph().addNode(T_map_robot);
  map.keyframes().push_back(std::move(keyframe));
  map.links().addKeyframe();
  if (before < 0) {
    if (k == 0) map.graph().setFixed(0);
    return k;
  }
  posegraph::Edge edge;
  edge.from = before, edge.to = k;
  edge.T_from_to = core::between(map.pose(before), T_map_robot);
  map.keyframes().back().odometry_edge = map.graph().addEdge(edge);
  map.link(before, k);
  return k;
}

/// Keyframes a metre apart along x, each in the middle of a round room.
inline void addRow(KeyframeMap& map, int count) {
  for (int i = 0; i < count; ++i)
    addKeyframe(map, {1.0 * i, 0, 0}, roundRoom(5), 1.0 * i, i == 0 ? -1 : map.lastKeyframe());
}

/// Finds all poses anew, and takes them over.
inline void settleAtOnce(KeyframeMap& map) {
  posegraph::OptimizeOptions options;
  options.robust = "none";
  Settling settling(map, options);
  double unlimited = std::numeric_limits<double>::infinity();
  settling.advance(unlimited);
  map.settle(settling.result());
}

}  // namespace slam::keyframes::test_maps
