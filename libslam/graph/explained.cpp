#include <algorithm>

#include "libslam/core/rigid_motion2.h"
#include "libslam/graph/graph_slam.h"
#include "libslam/keyframes/matching.h"

namespace slam::graph {

using core::Point2;
using core::Pose2;
using scanmatch::PatchPoint;

/// The share that is explained at a pose of those points of which the map says something: that fall on a
/// surface, or where beams of the keyframes nearest have passed. Points beyond what was seen, and between two
/// beams far apart, are left out, as long as there are others enough.
double GraphSlam::toldScore(const std::vector<PatchPoint>& points, const Pose2& T_map_robot) const {
  constexpr double kLeastTold = 0.2;
  const auto viewers = keyframes::firstOf(map_keyframes_, keyframes::kAskedViewers);
  const Point2 origin = maps_.fine.origin();
  const auto beams = map_->beamsOf(viewers);
  const core::RigidMotion2 T_map_points(T_map_robot);
  std::vector<PatchPoint> told;
  for (const auto& point : points) {
    const Point2 p_map = T_map_points * position(point);
    bool is_told = maps_.fine.at(p_map.x - origin.x, p_map.y - origin.y) != nullptr;
    for (size_t i = 0; !is_told && i < beams.size(); ++i)
      is_told = beams[i].say(p_map) == keyframes::Sight::kPassed;
    if (is_told) told.push_back(point);
  }
  const double share = surfelScore(told, maps_.fine, T_map_robot, keyframes::kKernel, 1);
  const double least = kLeastTold * static_cast<double>(points.size());
  return share * std::min(1.0, static_cast<double>(told.size()) / std::max(least, 1.0));
}

/// By how much more of the scan a pose explains than another, by the points of which both say something:
/// those that fall on a surface, and those that beams have gone through. What falls into the unknown, or
/// between two beams of a keyframe far along a wall, says nothing against a pose.
double GraphSlam::gain(const std::vector<PatchPoint>& points, const Pose2& T_map_robot,
                       const Pose2& T_map_other) const {
  const auto viewers = keyframes::firstOf(map_keyframes_, keyframes::kAskedViewers);
  const Point2 origin = maps_.fine.origin();
  const auto beams = map_->beamsOf(viewers);
  const core::RigidMotion2 T_here(T_map_robot), T_there(T_map_other);
  const auto says = [&](const core::RigidMotion2& T, const PatchPoint& point) {
    const Point2 p_map = T * position(point);
    bool agreed = false;
    for (const auto& viewer : beams) {
      const keyframes::Sight seen = viewer.say(p_map);
      if (seen == keyframes::Sight::kPassed) return true;
      agreed = agreed || seen == keyframes::Sight::kAgreed;
    }
    return agreed && maps_.fine.at(p_map.x - origin.x, p_map.y - origin.y) != nullptr;
  };
  std::vector<PatchPoint> telling;
  for (size_t p = 0; p < points.size(); p += keyframes::kStride)
    if (says(T_here, points[p]) && says(T_there, points[p])) telling.push_back(points[p]);
  return surfelScore(telling, maps_.fine, T_map_robot, keyframes::kKernel, 1) -
         surfelScore(telling, maps_.fine, T_map_other, keyframes::kKernel, 1);
}

}  // namespace slam::graph
