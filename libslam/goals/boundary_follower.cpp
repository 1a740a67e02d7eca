#include "libslam/goals/boundary_follower.h"

#include <cmath>

#include "libslam/core/elementary.h"

namespace slam::goals {
namespace {

constexpr int kSweepSteps = 180;
constexpr double kSweepStep_rad = 2 * core::kPi / kSweepSteps;
// The same contact seen from places within the tolerance, noise included; the other side of a passage
// differs by half a turn.
constexpr double kSameBearing_rad = core::degToRad(70);
constexpr double kRegainWithin_m = 0.3;

}  // namespace

void BoundaryFollower::begin(const Surroundings& surroundings, const core::Pose2& T_odom_robot,
                             double blocked_rad) {
  const auto stop = surroundings.way(blocked_rad, surroundings.followRadius()).stop;
  const double reach_m = surroundings.followRadius();
  p_odom_contact_ = T_odom_robot * stop.value_or(core::polar(reach_m, blocked_rad));
  first_blocked_rad_ = core::wrapToPi(T_odom_robot.phi + blocked_rad);
  startRound(T_odom_robot);
}

void BoundaryFollower::reverse(const core::Pose2& T_odom_robot) {
  wall_on_right_ = !wall_on_right_;
  first_blocked_rad_.reset();
  startRound(T_odom_robot);
}

void BoundaryFollower::startRound(const core::Pose2& T_odom_robot) {
  T_odom_start_ = T_odom_last_ = T_odom_robot;
  start_bearing_rad_.reset();
  length_m_ = farthest_m_ = wound_rad_ = 0;
}

bool BoundaryFollower::sweep(const Surroundings& surroundings, const core::Pose2& T_odom_robot,
                             double start_rad, double radius_m, double step_m) {
  core::Point2 p_contact = core::inverse(T_odom_robot) * p_odom_contact_;
  for (int i = 0; i < kSweepSteps; ++i) {
    const double angle_rad = start_rad + (wall_on_right_ ? i : -i) * kSweepStep_rad;
    const auto way = surroundings.way(angle_rad, radius_m);
    if (way.free_m < step_m) {
      p_contact = *way.stop;
      continue;
    }
    direction_rad_ = core::wrapToPi(angle_rad);
    p_odom_contact_ = T_odom_robot * p_contact;
    return true;
  }
  return false;
}

BoundaryFollower::Result BoundaryFollower::update(const Surroundings& surroundings,
                                                  const core::Pose2& T_odom_robot) {
  const double step_m = surroundings.step_m();
  core::Point2 p_contact = core::inverse(T_odom_robot) * p_odom_contact_;
  double start_rad = first_blocked_rad_ ? core::angleDifference(*first_blocked_rad_, T_odom_robot.phi)
                                        : core::atan2(p_contact.y, p_contact.x);
  const double follow_m = surroundings.followRadius();
  if (!first_blocked_rad_ && surroundings.way(start_rad, follow_m).free_m >= step_m) {
    if (core::hypot(p_contact.x, p_contact.y) > follow_m + step_m) {
      direction_rad_ = start_rad;
      track(T_odom_robot);
      return Result::kFollowing;
    }
    // The contact was a stray reading, or it has moved: take the nearest thing instead.
    const auto nearest = surroundings.nearestWithin(follow_m + kRegainWithin_m);
    if (!nearest) return Result::kWallLost;
    p_odom_contact_ = T_odom_robot * *nearest;
    start_rad = core::atan2(nearest->y, nearest->x);
  }
  for (const double radius_m : {follow_m, surroundings.passRadius(), surroundings.guardRadius()}) {
    if (!sweep(surroundings, T_odom_robot, start_rad, radius_m, step_m)) continue;
    first_blocked_rad_.reset();
    track(T_odom_robot);
    return Result::kFollowing;
  }
  return Result::kBoxedIn;
}

void BoundaryFollower::track(const core::Pose2& T_odom_robot) {
  const double bearing_rad =
      core::atan2(p_odom_contact_.y - T_odom_robot.y, p_odom_contact_.x - T_odom_robot.x);
  if (start_bearing_rad_)
    wound_rad_ += core::angleDifference(bearing_rad, contact_bearing_rad_);
  else
    start_bearing_rad_ = bearing_rad;
  contact_bearing_rad_ = bearing_rad;
  length_m_ += core::distance(T_odom_last_, T_odom_robot);
  farthest_m_ = std::max(farthest_m_, core::distance(T_odom_start_, T_odom_robot));
  T_odom_last_ = T_odom_robot;
}

bool BoundaryFollower::isAt(const core::Pose2& T_odom_then, double bearing_rad) const {
  return core::distance(T_odom_then, T_odom_last_) <= tolerance_m_ &&
         std::abs(core::angleDifference(bearing_rad, contact_bearing_rad_)) <= kSameBearing_rad;
}

bool BoundaryFollower::closed() const {
  if (!start_bearing_rad_) return false;
  if (farthest_m_ > 2 * tolerance_m_) return isAt(T_odom_start_, *start_bearing_rad_);
  return std::abs(wound_rad_) > 2 * core::kPi + kSameBearing_rad;
}

}  // namespace slam::goals
