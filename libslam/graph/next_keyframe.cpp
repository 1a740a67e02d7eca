#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/graph/graph_slam.h"

/// Which scan becomes a keyframe.
namespace slam::graph {
namespace {

using core::Pose2;
using scanmatch::PatchPoint;

/// Where a scan contradicts known ground it has to have moved by this share of a keyframe's distance, or
/// angle, to become one.
constexpr double kSoonest = 1.0 / 3;

}  // namespace

/// Whether one more keyframe tells nothing here. While a loop is followed or closed, and in doubt, it may.
bool GraphSlam::isKnownGround(const lidar::Scan& scan, const Pose2& T_map_robot) const {
  if (doubt_.begins >= 0 || tracker_.isFollowingWheels() || loops_.isFollowing() || loops_.isClosing())
    return false;
  return known_ground_.isKnown(scan, T_map_robot, around().keyframes());
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
  if (known_ground_.hasChanged(scan, points, step.T_map_robot, around().keyframes(), anchor_)) return true;
  hangOn(around().keyframes().front(), step.T_map_robot);
  return false;
}

/// The robot's pose, and that of the scans to come, is told by keyframe k.
void GraphSlam::hangOn(int k, const Pose2& T_map_robot) {
  anchor_ = k;
  T_keyframe_robot_ = T_keyframe_hung_ = T_odometry_ = core::between(map_->pose(k), T_map_robot);
  odometry_holds_ = true;
  T_wheels_ = {};
  uncertainty_.hangOnKeyframe();
  setMapHere();
}

}  // namespace slam::graph
