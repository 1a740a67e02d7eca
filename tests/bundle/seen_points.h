#pragma once
#include <vector>

#include "libslam/scanmatch/information.h"
#include "tests/keyframes/drawn_map.h"

/// Keyframes that have seen the points that a test wants.
namespace slam::bundle::test_points {

using Points = std::vector<scanmatch::PatchPoint>;

/// One in the middle of each cell of 0.1 m between two places, seen from smaller x.
inline Points alongY(double x, double first_y, double last_y) {
  Points points;
  for (int i = 0; first_y + 0.1 * i < last_y; ++i)
    points.push_back({static_cast<float>(x), static_cast<float>(first_y + 0.1 * i + 0.05), 0, 0.03F});
  return points;
}

/// The same along x, seen from smaller y.
inline Points alongX(double y, double first_x, double last_x) {
  Points points;
  for (const auto& point : alongY(y, first_x, last_x))
    points.push_back({point.y, point.x, -point.along_y, 0});
  return points;
}

/// A keyframe that has seen these, robot frame, and was reached from `before`; -1: from nowhere.
inline int addSeen(keyframes::KeyframeMap& map, const core::Pose2& T_map_robot, const Points& points,
                   int before) {
  const int k = keyframes::test_maps::addKeyframe(map, T_map_robot, keyframes::test_maps::roundRoom(5),
                                                  0.3 * map.size(), before);
  map.keyframes().back().points = points;
  map.keyframes().back().inherited.points_err = 1;
  return k;
}

}  // namespace slam::bundle::test_points
