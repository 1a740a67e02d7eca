#pragma once
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "libslam/keyframes/keyframe_map.h"
#include "libslam/keyframes/matching.h"
#include "libslam/scanmatch/information.h"

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
  keyframe.view_centre = centreOf(keyframe.points);
  keyframe.path_m = path_m;
  keyframe.odometry_edge = -1;
  keyframe.noise.setZero();
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

/// What keyframes err by, as odometry's edges have it: a quarter of their standard deviations, since loops
/// are judged as if ways erred by four times as much as is claimed.
inline void drawErrors(KeyframeMap& map) {
  for (int k = 1; k < map.size(); ++k) {
    if (map.keyframe(k).odometry_edge < 0) continue;  // where it is reached from nowhere
    const posegraph::Edge& edge = map.graph().edges()[static_cast<size_t>(map.keyframe(k).odometry_edge)];
    ErrorSamples errors;
    errors.add(moved(core::position(map.pose(edge.from)), core::position(map.pose(k))),
               map.errorsOf(edge.from));
    errors.addNew(scanmatch::covarianceOf(scanmatch::turned(edge.information, -map.pose(k).phi)) / 16,
                  static_cast<std::uint64_t>(k));
    map.setErrors(k, errors);
  }
}

/// Keyframes a metre apart along x, each in the middle of a round room.
inline void addRow(KeyframeMap& map, int count) {
  for (int i = 0; i < count; ++i)
    addKeyframe(map, {1.0 * i, 0, 0}, roundRoom(5), 1.0 * i, i == 0 ? -1 : map.lastKeyframe());
}

}  // namespace slam::keyframes::test_maps
