#include <algorithm>
#include <cmath>

#include "libslam/mapping/graph_slam.h"

namespace slam::mapping {
namespace {

using core::Point2;
using core::Pose2;
using scanmatch::PatchPoint;

/// Keyframes that are all learnt from; then one in so many.
constexpr int kLearntSoon = 20;
constexpr double kGoldenAngle_rad = 2.399963;
/// A wrong place that is matched nearer to the right heading is none.
constexpr double kFoundBack_rad = 0.3;

}  // namespace

double GraphSlam::View::conflict() const {
  return agreed + passed == 0 ? 0 : static_cast<double>(passed) / (agreed + passed);
}

GraphSlam::Sight GraphSlam::sight(int viewer, const Point2& p_lidar) const {
  // Half of what two walls are apart at least; and beams are compared with their neighbours.
  constexpr double kSame_m = 0.3;
  const auto& ranges = keyframe(viewer).ranges_m;
  double angle = std::atan2(p_lidar.y, p_lidar.x) - geometry_.first_angle_rad;
  if (angle < 0) angle += 2 * core::kPi;
  const auto beam = std::lround(angle / geometry_.step_rad);
  if (beam < 1 || beam + 1 >= static_cast<long>(ranges.size())) return Sight::kUnseen;
  const double distance_m = std::hypot(p_lidar.x, p_lidar.y);
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

GraphSlam::View GraphSlam::view(int viewer, const Pose2& T_viewer_points,
                                const std::vector<PatchPoint>& points) const {
  const Pose2 T_lidar_points = core::inverse(geometry_.T_robot_lidar) * T_viewer_points;
  View result;
  for (const auto& point : points) {
    const Sight seen = sight(viewer, T_lidar_points * position(point));
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

/// What a scan says of whether the robot was carried away. A scan that the map explains does not contradict it, whatever
/// beams went through where somebody stands now.
void GraphSlam::lookWhetherLost(const std::vector<PatchPoint>& points, const Step& step, double time_s,
                                const Pose2& increment) {
  const auto viewers = firstOf(map_keyframes_, kAskedViewers);
  double conflict = 0, telling = 0;
  for (const int viewer : viewers) {
    const View seen = view(viewer, core::between(graph_.pose(viewer), step.T_map_robot), points);
    conflict += seen.conflict();
    telling += seen.agreed + seen.passed;
  }
  const double all = static_cast<double>(viewers.size() * points.size());
  if (all == 0) return;
  const double share = std::min(conflict / static_cast<double>(viewers.size()), 1 - step.score);
  lost_.look(time_s, std::hypot(increment.x, increment.y), share, telling / all,
             step.score < options_.lost_score);
}

/// What a scan contradicts where the robot is not: turned on the spot, and matched again as a robot that was carried would
/// be.
void GraphSlam::learnWrongPlace(const std::vector<PatchPoint>& points, const Pose2& T_map_robot) {
  // Often in the beginning, seldom when much is known.
  ++wrong_places_;
  if (wrong_places_ > kLearntSoon && wrong_places_ % kLearntSoon != 0) return;
  const auto viewers = firstOf(map_keyframes_, kAskedViewers);
  if (viewers.empty() || points.empty()) return;
  const double turn = 0.5 + std::fmod(wrong_places_ * kGoldenAngle_rad, 2 * core::kPi - 1);
  const Pose2 wrong{T_map_robot.x, T_map_robot.y, T_map_robot.phi + turn};
  scanmatch::PosePrior flat;
  flat.mean = wrong;
  flat.information.setIdentity();
  const auto matched = match(points, maps_, wrong, flat, 0, true);
  if (std::abs(core::angleDifference(matched.T_map_robot.phi, T_map_robot.phi)) < kFoundBack_rad) return;
  lost_.learnWrong(
      std::min(meanConflict(viewers, matched.T_map_robot, points), std::max(1 - matched.score, 0.0)));
}

/// By how much more of the scan a pose explains than another, by the points of which both say something: those that fall
/// on a surface, and those that beams have gone through. What falls into the unknown, or between two beams of a keyframe
/// far along a wall, says nothing against a pose.
double GraphSlam::gain(const std::vector<PatchPoint>& points, const Pose2& T_map_robot,
                       const Pose2& T_map_other) const {
  const auto viewers = firstOf(map_keyframes_, kAskedViewers);
  const Pose2 T_lidar_robot = core::inverse(geometry_.T_robot_lidar);
  const Point2 origin = maps_.fine.origin();
  const auto says = [&](const Pose2& T, const PatchPoint& point) {
    const Point2 p_map = T * position(point);
    bool agreed = false;
    for (const int viewer : viewers) {
      const Sight seen = sight(viewer, T_lidar_robot * (core::inverse(graph_.pose(viewer)) * p_map));
      if (seen == Sight::kPassed) return true;
      agreed = agreed || seen == Sight::kAgreed;
    }
    return agreed && maps_.fine.at(p_map.x - origin.x, p_map.y - origin.y) != nullptr;
  };
  std::vector<PatchPoint> telling;
  for (size_t p = 0; p < points.size(); p += kStride)
    if (says(T_map_robot, points[p]) && says(T_map_other, points[p])) telling.push_back(points[p]);
  return surfelScore(telling, maps_.fine, T_map_robot, kKernel, 1) -
         surfelScore(telling, maps_.fine, T_map_other, kKernel, 1);
}

}  // namespace slam::mapping
