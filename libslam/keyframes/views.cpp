#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/keyframes/keyframe_map.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"

namespace slam::keyframes {

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

double View::conflict() const {
  return agreed + passed == 0 ? 0 : static_cast<double>(passed) / (agreed + passed);
}

std::vector<Beams> KeyframeMap::beamsOf(const std::vector<int>& viewers) const {
  std::vector<Beams> beams;
  beams.reserve(viewers.size());
  for (const int viewer : viewers)
    beams.emplace_back(keyframe(viewer).seen, core::inverse(graph_.pose(viewer)));
  return beams;
}

View KeyframeMap::view(int viewer, const Pose2& T_viewer_points,
                       const std::vector<PatchPoint>& points) const {
  return keyframes::view(keyframe(viewer).seen, T_viewer_points, points);
}

View view(const lidar::Scan& scan, const Pose2& T_viewer_points, const std::vector<PatchPoint>& points,
          size_t stride) {
  return Beams(scan, T_viewer_points).sayOf(points, stride);
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
    const size_t taken = (asked + kStride - 1) / kStride;
    const double all = static_cast<double>(taken);
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
      const View seen = keyframes::view(keyframe(other).seen, core::between(graph_.pose(other), T_map_robot),
                                        points, kStride);
      if (seen.conflict() > options_.link_conflict ||
          kStride * seen.agreed < options_.link_agreed * static_cast<double>(points.size()))
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
