#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/graph/graph_slam.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"

/// Ground that was seen often enough costs no more: the robot goes on along the keyframes that are there (the
/// idea of a reduced pose graph: Johannsson et al., ICRA 2013). So time and memory grow with the area, and
/// not with the years.
namespace slam::graph {
namespace {

using core::Point2;
using core::Pose2;
using scanmatch::PatchPoint;

/// Where a scan contradicts known ground it has to have moved by this share of a keyframe's distance, or
/// angle, to become one.
constexpr double kSoonest = 1.0 / 3;
/// The oldest keyframe goes among those that share more of the view than this.
constexpr double kSameView = 0.5;
/// Points, point_spacing_m apart, that have to be seen changed: a chair.
constexpr int kLeastChanged = 5;

}  // namespace

/// Whether the keyframes around see all that a scan sees, often enough, so that one more tells nothing.
bool GraphSlam::isKnownGround(const lidar::Scan& scan, const Pose2& T_map_robot) const {
  if (options_.known_views <= 0 || doubt_.begins >= 0 || by_wheels_ || loops_.isFollowing() ||
      loops_.isClosing())
    return false;
  return map_->viewsOf(scan, T_map_robot, map_keyframes_) >= options_.known_views;
}

/// Whether the robot has gone so far since its last keyframe, or since it was hung on one, that it needs
/// another.
bool GraphSlam::hasGoneOn(double share) const {
  const Pose2 gone = core::between(T_keyframe_hung_, T_keyframe_robot_);
  return core::hypot(gone.x, gone.y) > share * options_.keyframe_distance_m ||
         std::abs(gone.phi) > share * options_.keyframe_angle_rad;
}

/// Whether a scan that is believed becomes a keyframe. On known ground the robot is hung on the keyframe
/// nearest to it instead, unless something has changed there; and a scan that is not explained is learnt as
/// the robot moves on, not again and again while it stands.
bool GraphSlam::needsKeyframe(const lidar::Scan& scan, const std::vector<PatchPoint>& points,
                              const Step& step) {
  const bool has_gone_on = hasGoneOn(1), is_explained = step.score >= options_.keyframe_score;
  is_known_ground_ = false;
  if (!has_gone_on && is_explained) return false;
  is_known_ground_ = isKnownGround(scan, step.T_map_robot);
  if (!is_known_ground_) return true;
  if (!is_explained) return hasGoneOn(kSoonest);
  if (hasChanged(scan, points, step.T_map_robot)) return true;
  hangOn(map_keyframes_.front(), step.T_map_robot);
  return false;
}

/// The robot's pose, and that of the scans to come, is told by keyframe k.
void GraphSlam::hangOn(int k, const Pose2& T_map_robot) {
  anchor_ = k;
  T_keyframe_robot_ = T_keyframe_hung_ = T_odometry_ = core::between(map_->pose(k), T_map_robot);
  odometry_holds_ = true;
  from_keyframe_ = noise_;
  setMapHere();
}

/// Whether something has been there for a while where none of the keyframes around saw it. What has gone is
/// forgotten.
bool GraphSlam::hasChanged(const lidar::Scan& scan, const std::vector<PatchPoint>& points,
                           const Pose2& T_map_robot) {
  const auto viewers = keyframes::firstOf(map_keyframes_, keyframes::kAskedViewers);
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
  if (gone >= kLeastChanged) forgetGone(scan, T_map_robot);
  return changed >= kLeastChanged;
}

/// What a scan sees through, and what has been seen through for a while, is taken out of the keyframes
/// around.
void GraphSlam::forgetGone(const lidar::Scan& scan, const Pose2& T_map_robot) {
  const keyframes::Beams now(scan, core::inverse(T_map_robot));
  const auto isGone = [&](const Point2& p_map) {
    return gone_.hasStayed(p_map) && now.say(p_map) == keyframes::Sight::kPassed;
  };
  // Not what merely lies near: a part whose place is not known, or a pass whose loop is not closed.
  for (const int other : map_->keyframesAround(anchor_, core::position(T_map_robot), options_.map_path_m,
                                               options_.map_radius_m)) {
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

/// Keyframe k, made on known ground, takes the place of the oldest one that sees the same.
void GraphSlam::retireOldest(int k) {
  const auto& newest = map_->keyframe(k);
  double views = 0;
  int oldest = k;
  const double nearby_m = keyframes::kNearby * options_.keyframe_distance_m;
  for (const int other :
       map_->keyframesAround(k, core::position(map_->pose(k)), options_.map_path_m, nearby_m)) {
    if (other == k) continue;
    const double shared =
        keyframes::sharedView(newest.seen, map_->pose(k), map_->keyframe(other).seen, map_->pose(other));
    views += shared;
    if (shared > kSameView) oldest = std::min(oldest, other);
  }
  if (views < options_.known_views || oldest == k) return;
  keyframes::Keyframe& known = map_->keyframes()[static_cast<size_t>(oldest)];
  known.is_retired = true;
  known.points = {}, known.seen.ranges_m = {};
  map_->links().remove(oldest);
  map_->countRevision();
}

}  // namespace slam::graph
