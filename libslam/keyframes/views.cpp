#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/core/rigid_motion2.h"
#include "libslam/keyframes/keyframe_map.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"

namespace slam::keyframes {

using core::Point2;
using core::Pose2;
using scanmatch::PatchPoint;

namespace {

constexpr int kPartnerStep = 3;

/// Two partners of a keyframe are so many keyframes apart: neighbours would say the same twice.
bool isApart(int keyframe, const std::vector<int>& others) {
  return std::none_of(others.begin(), others.end(),
                      [&](int other) { return std::abs(other - keyframe) < kPartnerStep; });
}

}  // namespace

double sharedView(const lidar::Scan& scan, const Pose2& T_map_robot, const lidar::Scan& other,
                  const Pose2& T_map_other) {
  const auto width = [](const lidar::Scan& s) {
    return std::min(static_cast<double>(s.ranges_m.size()) * s.step_rad, 2 * core::kPi);
  };
  const auto middle = [&](const lidar::Scan& s, const Pose2& T) {
    return T.phi + s.T_robot_lidar.phi + s.first_angle_rad + width(s) / 2;
  };
  const double its = width(scan), theirs = width(other);
  const double apart = std::abs(core::angleDifference(middle(scan, T_map_robot), middle(other, T_map_other)));
  const double one_way = std::min({its, theirs, (its + theirs) / 2 - apart}),
               other_way = (its + theirs) / 2 - (2 * core::kPi - apart);
  return std::clamp((std::max(one_way, 0.0) + std::max(other_way, 0.0)) / its, 0.0, 1.0);
}

namespace {

/// The beam, counted from the first, nearest to the direction of a point. As core::atan2() rounded has it,
/// but that is seldom asked: to 1e-5 rad a polynomial knows the angle (Abramowitz and Stegun, 4.4.49), and
/// most directions are farther from the middle between two beams.
long beamTowards(const Point2& p, double first_angle_rad, double step_rad) {
  constexpr double kError_rad = 1.2e-5;
  const auto beam = [&](double angle_rad) {
    const double angle = angle_rad - first_angle_rad;
    return (angle < 0 ? angle + 2 * core::kPi : angle) / step_rad;
  };
  const double x = std::abs(p.x), y = std::abs(p.y), least = std::min(x, y), most = std::max(x, y);
  if (most > 0) {
    const double t = least / most, t2 = t * t;
    double angle =
        t * (0.9998660 + t2 * (-0.3302995 + t2 * (0.1801410 + t2 * (-0.0851330 + t2 * 0.0208351))));
    if (y > x) angle = core::kPi / 2 - angle;
    if (p.x < 0) angle = core::kPi - angle;
    if (p.y < 0) angle = -angle;
    const double rough = beam(angle), error = kError_rad / step_rad;
    const double above = std::floor(rough + error + 0.5);
    // Beside the seam behind the robot the two angles can lie a turn apart.
    const bool is_clear = std::abs(angle) < 3.14 && std::abs(angle - first_angle_rad) > kError_rad;
    if (is_clear && above == std::floor(rough - error + 0.5) && rough > 0.5) return static_cast<long>(above);
  }
  return std::lround(beam(core::atan2(p.y, p.x)));
}

}  // namespace

double View::conflict() const {
  return agreed + passed == 0 ? 0 : static_cast<double>(passed) / (agreed + passed);
}

Sight sight(const lidar::Scan& seen, const Point2& p_lidar) {
  const auto& ranges = seen.ranges_m;
  // Half of what two walls are apart at least; and beams are compared with their neighbours.
  constexpr double kSame_m = 0.3;
  const long beam = beamTowards(p_lidar, seen.first_angle_rad, seen.step_rad);
  if (beam < 1 || beam + 1 >= static_cast<long>(ranges.size())) return Sight::kUnseen;
  const double distance_m = core::hypot(p_lidar.x, p_lidar.y);
  double off_m = 1e9, nearest_m = 1e9;
  for (long b = beam - 1; b <= beam + 1; ++b) {
    const float range_m = ranges[static_cast<size_t>(b)];
    if (!lidar::isReturn(range_m)) continue;
    off_m = std::min(off_m, std::abs(range_m - distance_m));
    nearest_m = std::min(nearest_m, static_cast<double>(range_m));
  }
  if (off_m < kSame_m) return Sight::kAgreed;
  return nearest_m < 1e9 && nearest_m > distance_m + kSame_m ? Sight::kPassed : Sight::kUnseen;
}

Sight KeyframeMap::sight(int viewer, const Point2& p_lidar) const {
  return keyframes::sight(keyframe(viewer).seen, p_lidar);
}

std::vector<Pose2> KeyframeMap::lidarsOf(const std::vector<int>& viewers) const {
  std::vector<Pose2> T_lidars_map;
  T_lidars_map.reserve(viewers.size());
  for (const int viewer : viewers)
    T_lidars_map.push_back(core::inverse(graph_.pose(viewer) * keyframe(viewer).seen.T_robot_lidar));
  return T_lidars_map;
}

View KeyframeMap::view(int viewer, const Pose2& T_viewer_points,
                       const std::vector<PatchPoint>& points) const {
  return keyframes::view(keyframe(viewer).seen, T_viewer_points, points);
}

View view(const lidar::Scan& scan, const Pose2& T_viewer_points, const std::vector<PatchPoint>& points,
          size_t stride) {
  const core::RigidMotion2 T_lidar_points(core::inverse(scan.T_robot_lidar) * T_viewer_points);
  View result;
  for (size_t i = 0; i < points.size(); i += stride) {
    const Sight seen = sight(scan, T_lidar_points * position(points[i]));
    if (seen == Sight::kAgreed) ++result.agreed;
    if (seen == Sight::kPassed) ++result.passed;
  }
  return result;
}

double KeyframeMap::meanConflict(const std::vector<int>& viewers, const Pose2& T_map_points,
                                 const std::vector<PatchPoint>& points) const {
  double sum = 0;
  for (const int viewer : viewers)
    sum += view(viewer, core::between(graph_.pose(viewer), T_map_points), points).conflict();
  return viewers.empty() ? 0 : sum / static_cast<double>(viewers.size());
}

Told KeyframeMap::toldBy(const std::vector<int>& viewers, const std::vector<PatchPoint>& points,
                         const Pose2& T_map_robot, const lidar::Scan* scan) const {
  Told told;
  if (viewers.empty() || points.empty()) return told;
  const auto add = [](const View& seen, size_t asked, double& passed, double& share) {
    const double all = static_cast<double>((asked + kStride - 1) / kStride);
    passed += seen.passed / all;
    share += (seen.agreed + seen.passed) / all;
  };
  for (const int viewer : viewers) {
    double passed = 0, theirs = 0, its = 0;
    const Pose2 T_viewer_scan = core::between(graph_.pose(viewer), T_map_robot);
    add(keyframes::view(keyframe(viewer).seen, T_viewer_scan, points, kStride), points.size(), passed,
        theirs);
    const auto& known = keyframe(viewer).points;
    if (scan != nullptr && !known.empty())
      add(keyframes::view(*scan, core::inverse(T_viewer_scan), known, kStride), known.size(), passed, its);
    if (theirs + its > 0) told.contradicted += passed / (theirs + its);
    told.telling += std::max(theirs, its);
  }
  told.contradicted /= static_cast<double>(viewers.size());
  told.telling /= static_cast<double>(viewers.size());
  return told;
}

std::vector<int> KeyframeMap::viewersOf(const lidar::Scan& scan, const Pose2& T_map_robot,
                                        const std::vector<int>& among, int most) const {
  constexpr double kHalf = 0.5;
  std::vector<int> viewers;
  for (const int k : among) {
    if (static_cast<int>(viewers.size()) == most) break;
    if (sharedView(scan, T_map_robot, keyframe(k).seen, graph_.pose(k)) >= kHalf) viewers.push_back(k);
  }
  return viewers;
}

double KeyframeMap::viewsOf(const lidar::Scan& scan, const Pose2& T_map_robot,
                            const std::vector<int>& among) const {
  double views = 0;
  for (const int k : among)
    if (core::distance(graph_.pose(k), T_map_robot) <= kNearby * options_.keyframe_distance_m)
      views += sharedView(scan, T_map_robot, keyframe(k).seen, graph_.pose(k));
  return views;
}

std::vector<int> KeyframeMap::partnersOf(int k, const std::vector<int>& near,
                                         const Pose2& T_map_robot) const {
  std::vector<int> partners;
  const auto& points = keyframe(k).points;
  for (const int other : near) {
    if (other == k || !isApart(other, partners)) continue;
    if (other != keyframeBefore(k)) {
      const View seen = view(other, core::between(graph_.pose(other), T_map_robot), points);
      if (seen.conflict() > options_.link_conflict ||
          seen.agreed < options_.link_agreed * static_cast<double>(points.size()))
        continue;
    }
    partners.push_back(other);
    if (static_cast<int>(partners.size()) == options_.edges_per_keyframe) break;
  }
  return partners;
}

/// Of what speaks of a scan's place, the share that speaks against it, when the map explains so much of the
/// scan.
double Told::against(double explained) const {
  const double against = contradicted * telling;
  return against + explained > 0 ? against / (against + explained) : 0;
}

}  // namespace slam::keyframes
