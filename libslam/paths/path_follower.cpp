#include "libslam/paths/path_follower.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/paths/expected_gain.h"
#include "libslam/safety/safe_motion.h"

namespace slam::paths {
namespace {

constexpr double kAtWaypoint_m = 0.12, kAtGoal_m = 0.06;
constexpr double kAside_m = 0.05;  // a straight line may end this far beside the waypoint
constexpr double kSmallestCorrection_rad = core::kPi / 90;
constexpr double kSmallestTurn_rad = 1e-3;
constexpr double kShortestDrive_m = 0.01;
constexpr double kSidestep_m = 0.2;
// Up to 100 degrees: right before a thing the disc can only go along it.
constexpr double kSidestepTurn_rad = core::kPi / 18;
constexpr int kSidestepTurns = 10, kMostSidesteps = 4;
constexpr double kProgress_m = 0.3;
constexpr double kInsideView_rad = core::kPi / 9;  // what is to be seen should not lie at the view's edge

robot::Command turnBy(double angle_rad, double most_rad, double period_s) {
  return {0, std::clamp(angle_rad, -most_rad, most_rad) / period_s, period_s};
}

}  // namespace

bool PathFollower::advanceWaypoint(const core::Pose2& T_map_robot) {
  const core::Point2 here = core::position(T_map_robot);
  if (detour_ && core::distance(*detour_, here) < kAtGoal_m) detour_.reset(), turning_ = false;
  while (waypoint_ < path_.size()) {
    const bool last = waypoint_ + 1 == path_.size();
    if (core::distance(path_[waypoint_], here) > (last ? kAtGoal_m : kAtWaypoint_m)) return true;
    ++waypoint_;
    turning_ = false;
    sidesteps_ = 0;
    detour_.reset();
  }
  return false;
}

std::optional<core::Point2> PathFollower::sidestep(const lidar::Scan& scan, const core::Pose2& T_map_robot,
                                                   const robot::RobotOptions& robot, double towards_rad,
                                                   const std::vector<core::Point2>& remembered) {
  const double rest_m = core::distance(path_[waypoint_], core::position(T_map_robot));
  if (sidesteps_ > 0 && rest_m < nearest_m_ - kProgress_m) sidesteps_ = 0;
  if (sidesteps_ == 0) nearest_m_ = rest_m;
  if (++sidesteps_ > kMostSidesteps) return std::nullopt;
  for (int i = 1; i <= kSidestepTurns; ++i)
    for (const int side : {1, -1}) {
      const double direction_rad = towards_rad + side * i * kSidestepTurn_rad;
      if (safety::discReach(scan, direction_rad, robot, remembered) < kSidestep_m) continue;
      return T_map_robot * core::polar(kSidestep_m, direction_rad);
    }
  return std::nullopt;
}

/// Turns begin when the straight line would end beside the waypoint, and are then carried out whole.
bool PathFollower::mustTurn(double error_rad, double rest_m, double most_rad) {
  if (turning_) {
    // The last part of a turn is not corrected again: noise of the pose would keep it turning.
    turning_ = std::abs(error_rad) > most_rad;
    return std::abs(error_rad) > kSmallestTurn_rad;
  }
  if (std::abs(error_rad) <= std::max(kSmallestCorrection_rad, core::atan2(kAside_m, rest_m))) return false;
  turning_ = std::abs(error_rad) > most_rad;
  return true;
}

PathFollower::Step PathFollower::next(const lidar::Scan& scan, const core::Pose2& T_map_robot,
                                      const robot::RobotOptions& robot, double slow_clearance_m,
                                      double period_s, const std::vector<core::Point2>& remembered) {
  const robot::Command stand{0, 0, period_s};
  const double most_rad = robot.max_turn_rate_radps * period_s;
  const auto bearing = [&](const core::Point2& p_map) {
    return core::angleDifference(core::atan2(p_map.y - T_map_robot.y, p_map.x - T_map_robot.x),
                                 T_map_robot.phi);
  };
  if (!advanceWaypoint(T_map_robot)) {
    if (!look_at_ || sighted_) return {Status::kArrived, stand};
    const LookShape view = lookShape(scan);
    const double middle_rad = view.first_rad + 0.5 * view.fov_rad;
    const double error_rad = core::angleDifference(bearing(*look_at_), middle_rad);
    const double half_rad = 0.5 * view.fov_rad - std::min(kInsideView_rad, 0.25 * view.fov_rad);
    if (view.full_circle || std::abs(error_rad) <= half_rad) {
      sighted_ = true;
      return {Status::kArrived, stand};
    }
    sighted_ = std::abs(error_rad) <= most_rad;
    return {Status::kFollowing, turnBy(error_rad, most_rad, period_s)};
  }

  const core::Point2 target = detour_.value_or(path_[waypoint_]);
  const double rest_m = core::distance(target, core::position(T_map_robot));
  const double error_rad = bearing(target);
  if (mustTurn(error_rad, rest_m, most_rad))
    return {Status::kFollowing, turnBy(error_rad, most_rad, period_s)};
  if (!safety::seesAhead(scan)) return {Status::kBlocked, stand};
  const double speed_mps = safety::safeSpeed(scan, robot, slow_clearance_m, remembered);
  const double step_m =
      std::min({rest_m, speed_mps * period_s, safety::discReach(scan, 0, robot, remembered)});
  if (step_m >= kShortestDrive_m) return {Status::kFollowing, {step_m / period_s, 0, period_s}};
  detour_ = sidestep(scan, T_map_robot, robot, bearing(path_[waypoint_]), remembered);
  if (!detour_) return {Status::kBlocked, stand};
  turning_ = true;
  return {Status::kFollowing, turnBy(bearing(*detour_), most_rad, period_s)};
}

}  // namespace slam::paths
