#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/core/rigid_motion2.h"
#include "libslam/graph/graph_slam.h"

namespace slam::graph {
namespace {

using core::Point2;
using core::Pose2;
using scanmatch::PatchPoint;

}  // namespace

double View::conflict() const {
  return agreed + passed == 0 ? 0 : static_cast<double>(passed) / (agreed + passed);
}

/// What a scan says of a point in its lidar's frame.
Sight GraphSlam::sight(const robot::Scan& seen, const Point2& p_lidar) {
  const auto& ranges = seen.ranges_m;
  // Half of what two walls are apart at least; and beams are compared with their neighbours.
  constexpr double kSame_m = 0.3;
  double angle = core::atan2(p_lidar.y, p_lidar.x) - seen.first_angle_rad;
  if (angle < 0) angle += 2 * core::kPi;
  const auto beam = std::lround(angle / seen.step_rad);
  if (beam < 1 || beam + 1 >= static_cast<long>(ranges.size())) return Sight::kUnseen;
  const double distance_m = core::hypot(p_lidar.x, p_lidar.y);
  double off_m = 1e9, nearest_m = 1e9;
  for (long b = beam - 1; b <= beam + 1; ++b) {
    const float range_m = ranges[static_cast<size_t>(b)];
    if (!robot::isReturn(range_m)) continue;
    off_m = std::min(off_m, std::abs(range_m - distance_m));
    nearest_m = std::min(nearest_m, static_cast<double>(range_m));
  }
  if (off_m < kSame_m) return Sight::kAgreed;
  return nearest_m < 1e9 && nearest_m > distance_m + kSame_m ? Sight::kPassed : Sight::kUnseen;
}

Sight GraphSlam::sight(int viewer, const Point2& p_lidar) const {
  return sight(keyframe(viewer).seen, p_lidar);
}

/// From map to lidar, of each of these keyframes.
std::vector<Pose2> GraphSlam::lidarsOf(const std::vector<int>& viewers) const {
  std::vector<Pose2> T_lidars_map;
  T_lidars_map.reserve(viewers.size());
  for (const int viewer : viewers)
    T_lidars_map.push_back(core::inverse(graph_.pose(viewer) * keyframe(viewer).seen.T_robot_lidar));
  return T_lidars_map;
}

View GraphSlam::view(int viewer, const Pose2& T_viewer_points, const std::vector<PatchPoint>& points) const {
  return view(keyframe(viewer).seen, T_viewer_points, points);
}

View GraphSlam::view(const robot::Scan& scan, const Pose2& T_viewer_points,
                     const std::vector<PatchPoint>& points, size_t stride) {
  const core::RigidMotion2 T_lidar_points(core::inverse(scan.T_robot_lidar) * T_viewer_points);
  View result;
  for (size_t i = 0; i < points.size(); i += stride) {
    const Sight seen = sight(scan, T_lidar_points * position(points[i]));
    if (seen == Sight::kAgreed) ++result.agreed;
    if (seen == Sight::kPassed) ++result.passed;
  }
  return result;
}

/// What the beams of keyframes say of the points of a scan at a pose, on average; 0 without keyframes.
double GraphSlam::meanConflict(const std::vector<int>& viewers, const Pose2& T_map_points,
                               const std::vector<PatchPoint>& points) const {
  double sum = 0;
  for (const int viewer : viewers)
    sum += view(viewer, core::between(graph_.pose(viewer), T_map_points), points).conflict();
  return viewers.empty() ? 0 : sum / static_cast<double>(viewers.size());
}

/// The share that is explained at a pose of those points of which the map says something: that fall on a
/// surface, or where beams of the keyframes nearest have passed. Points beyond what was seen, and between two
/// beams far apart, are left out, as long as there are others enough.
double GraphSlam::toldScore(const std::vector<PatchPoint>& points, const Pose2& T_map_robot) const {
  constexpr double kLeastTold = 0.2;
  const auto viewers = firstOf(map_keyframes_, kAskedViewers);
  const Point2 origin = maps_.fine.origin();
  const auto poses = lidarsOf(viewers);
  const std::vector<core::RigidMotion2> T_lidars_map(poses.begin(), poses.end());
  const core::RigidMotion2 T_map_points(T_map_robot);
  std::vector<PatchPoint> told;
  for (const auto& point : points) {
    const Point2 p_map = T_map_points * position(point);
    bool is_told = maps_.fine.at(p_map.x - origin.x, p_map.y - origin.y) != nullptr;
    for (size_t i = 0; !is_told && i < viewers.size(); ++i)
      is_told = sight(viewers[i], T_lidars_map[i] * p_map) == Sight::kPassed;
    if (is_told) told.push_back(point);
  }
  const double share = surfelScore(told, maps_.fine, T_map_robot, kKernel, 1);
  const double least = kLeastTold * static_cast<double>(points.size());
  return share * std::min(1.0, static_cast<double>(told.size()) / std::max(least, 1.0));
}

/// By how much more of the scan a pose explains than another, by the points of which both say something:
/// those that fall on a surface, and those that beams have gone through. What falls into the unknown, or
/// between two beams of a keyframe far along a wall, says nothing against a pose.
double GraphSlam::gain(const std::vector<PatchPoint>& points, const Pose2& T_map_robot,
                       const Pose2& T_map_other) const {
  const auto viewers = firstOf(map_keyframes_, kAskedViewers);
  const Point2 origin = maps_.fine.origin();
  const auto poses = lidarsOf(viewers);
  const std::vector<core::RigidMotion2> T_lidars_map(poses.begin(), poses.end());
  const core::RigidMotion2 T_here(T_map_robot), T_there(T_map_other);
  const auto says = [&](const core::RigidMotion2& T, const PatchPoint& point) {
    const Point2 p_map = T * position(point);
    bool agreed = false;
    for (size_t i = 0; i < viewers.size(); ++i) {
      const Sight seen = sight(viewers[i], T_lidars_map[i] * p_map);
      if (seen == Sight::kPassed) return true;
      agreed = agreed || seen == Sight::kAgreed;
    }
    return agreed && maps_.fine.at(p_map.x - origin.x, p_map.y - origin.y) != nullptr;
  };
  std::vector<PatchPoint> telling;
  for (size_t p = 0; p < points.size(); p += kStride)
    if (says(T_here, points[p]) && says(T_there, points[p])) telling.push_back(points[p]);
  return surfelScore(telling, maps_.fine, T_map_robot, kKernel, 1) -
         surfelScore(telling, maps_.fine, T_map_other, kKernel, 1);
}

}  // namespace slam::graph
