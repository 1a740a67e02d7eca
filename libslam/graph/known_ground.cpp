#include "libslam/graph/known_ground.h"

#include <algorithm>

#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"

namespace slam::graph {
namespace {

using core::Point2;
using core::Pose2;
using scanmatch::PatchPoint;

/// The oldest keyframe goes among those that share more of the view than this.
constexpr double kSameView = 0.5;
/// Points, point_spacing_m apart, that have to be seen changed: a chair.
constexpr int kLeastChanged = 5;

}  // namespace

bool KnownGround::isKnown(const lidar::Scan& scan, const Pose2& T_map_robot,
                          const std::vector<int>& near) const {
  return options_->known_views > 0 && map_->viewsOf(scan, T_map_robot, near) >= options_->known_views;
}

bool KnownGround::hasChanged(const lidar::Scan& scan, const std::vector<PatchPoint>& points,
                             const Pose2& T_map_robot, const std::vector<int>& near, int anchor) {
  const auto viewers = keyframes::firstOf(near, keyframes::kAskedViewers);
  const auto beams = map_->beamsOf(viewers);
  int changed = 0;
  for (const auto& point : points) {
    const Point2 p_map = T_map_robot * position(point);
    bool is_passed = false, is_agreed = false;
    for (const auto& viewer : beams) {
      const keyframes::Sight seen = viewer.say(p_map);
      is_passed = is_passed || seen == keyframes::Sight::kPassed,
      is_agreed = is_agreed || seen == keyframes::Sight::kAgreed;
    }
    if (is_passed && !is_agreed) changed += appeared_.look(p_map, scan.time_s);
  }
  const keyframes::Beams now(scan, core::inverse(T_map_robot));
  int gone = 0;
  for (const int viewer : viewers)
    for (const auto& point : map_->keyframe(viewer).points) {
      const Point2 p_map = map_->pose(viewer) * position(point);
      if (now.say(p_map) == keyframes::Sight::kPassed) gone += gone_.look(p_map, scan.time_s);
    }
  if (gone >= kLeastChanged) forgetGone(scan, T_map_robot, anchor);
  return changed >= kLeastChanged;
}

/// What a scan sees through, and what has been seen through for a while, is taken out of the keyframes
/// around.
void KnownGround::forgetGone(const lidar::Scan& scan, const Pose2& T_map_robot, int anchor) {
  const keyframes::Beams now(scan, core::inverse(T_map_robot));
  const auto isGone = [&](const Point2& p_map) {
    return gone_.hasStayed(p_map) && now.say(p_map) == keyframes::Sight::kPassed;
  };
  // Not what merely lies near: a part whose place is not known, or a pass whose loop is not closed.
  for (const int other : map_->keyframesAround(anchor, core::position(T_map_robot), options_->map_path_m,
                                               options_->map_radius_m)) {
    keyframes::Keyframe& known = map_->keyframes()[static_cast<size_t>(other)];
    const Pose2& T = map_->pose(other);
    const auto first = std::remove_if(known.points.begin(), known.points.end(),
                                      [&](const PatchPoint& point) { return isGone(T * position(point)); });
    if (first == known.points.end()) continue;
    known.points.erase(first, known.points.end());
    const Pose2 T_map_lidar = T * known.seen.T_robot_lidar;
    for (size_t beam = 0; beam < known.seen.ranges_m.size(); ++beam) {
      float& range_m = known.seen.ranges_m[beam];
      if (lidar::isReturn(range_m) && isGone(T_map_lidar * core::polar(range_m, known.seen.angle(beam))))
        range_m = lidar::kLostReading;
    }
    map_->countRevision();
  }
}

void KnownGround::retireOldest(int k) {
  const auto& newest = map_->keyframe(k);
  double views = 0;
  int oldest = k;
  const double nearby_m = keyframes::kNearby * options_->keyframe_distance_m;
  for (const int other :
       map_->keyframesAround(k, core::position(map_->pose(k)), options_->map_path_m, nearby_m)) {
    if (other == k) continue;
    const double shared =
        keyframes::sharedView(newest.seen, map_->pose(k), map_->keyframe(other).seen, map_->pose(other));
    views += shared;
    if (shared > kSameView) oldest = std::min(oldest, other);
  }
  if (views < options_->known_views || oldest == k) return;
  keyframes::Keyframe& known = map_->keyframes()[static_cast<size_t>(oldest)];
  known.is_retired = true;
  known.points = {}, known.seen.ranges_m = {};
  map_->links().remove(oldest);
  map_->countRevision();
}

}  // namespace slam::graph
