#include "libslam/goals/guarded_navigator.h"

#include <algorithm>
#include <cstdio>

#include "libslam/core/elementary.h"

namespace slam::goals {
namespace {

constexpr double kMostBlind_s = 5, kMostStill_s = 60;
constexpr double kSpot_m = 0.05;
constexpr double kNearGoal_m = 0.6;

bool seesNothing(const lidar::Scan& scan) {
  return std::none_of(scan.ranges_m.begin(), scan.ranges_m.end(),
                      [](float range_m) { return lidar::isReturn(range_m) || range_m == lidar::kNoReturn; });
}

}  // namespace

std::string describe(const core::Point2& p) {
  char text[64];
  std::snprintf(text, sizeof text, "(%.2f, %.2f)", p.x, p.y);
  return text;
}

GuardedNavigator::GuardedNavigator(const NavigateOptions& options, const GoalTask& task)
    : options_(options),
      task_(task),
      surroundings_(task.robot, options.clearance_m, task.period_s, options.memory, options.obstacles) {
  if (options.unseen == "looked_at") look_first_.emplace(task.robot, task.period_s, options.obstacles);
}

double GuardedNavigator::goalDistance(const core::Pose2& T_odom_robot) const {
  return core::distance(core::position(T_odom_robot), task_.p_odom_goal);
}

double GuardedNavigator::goalDirection(const core::Pose2& T_odom_robot) const {
  const core::Point2 p_robot = core::inverse(T_odom_robot) * task_.p_odom_goal;
  return core::atan2(p_robot.y, p_robot.x);
}

double GuardedNavigator::approachRadius(const core::Pose2& T_odom_robot) const {
  return goalDistance(T_odom_robot) < kNearGoal_m ? surroundings_.guardRadius() : surroundings_.passRadius();
}

double GuardedNavigator::freeToGoal(const core::Pose2& T_odom_robot) const {
  const auto way = surroundings_.way(goalDirection(T_odom_robot), approachRadius(T_odom_robot));
  return std::min(way.free_m, goalDistance(T_odom_robot));
}

GoalStep GuardedNavigator::end(GoalStatus status, const std::string& reason) {
  last_ = {surroundings_.stand(), status, endState(status), reason};
  return last_;
}

GoalStep GuardedNavigator::goOn(const robot::Command& command) {
  last_.command = command;
  last_.changes.clear();
  last_speed_mps_ = command.speed_mps;
  return last_;
}

bool GuardedNavigator::standsStill(const core::Pose2& T_odom_robot) {
  if (!has_spot_ || core::distance(T_odom_spot_, T_odom_robot) > kSpot_m) {
    has_spot_ = true;
    T_odom_spot_ = T_odom_robot;
    still_s_ = 0;
  }
  still_s_ += task_.period_s;
  return still_s_ > kMostStill_s;
}

GoalStep GuardedNavigator::next(const lidar::Scan& scan, const core::Pose2& T_odom_robot, bool collided) {
  if (last_.status != GoalStatus::kMoving) {
    last_.changes.clear();
    return last_;
  }
  if (!core::isFinite(T_odom_robot)) return end(GoalStatus::kGaveUp, "the pose is not finite");
  elapsed_s_ += task_.period_s;
  surroundings_.update(scan, T_odom_robot);
  if (look_first_) {
    look_first_->update(scan, T_odom_robot);
    surroundings_.add(look_first_->hidden());
  }
  if (collided) surroundings_.feel(T_odom_robot, last_speed_mps_ >= 0);
  if (goalDistance(T_odom_robot) <= options_.goal_tolerance_m)
    return end(GoalStatus::kReached,
               "the goal is " + files::formatNumber(options_.goal_tolerance_m) + " m away or nearer");
  if (elapsed_s_ > options_.time_limit_s)
    return end(GoalStatus::kGaveUp,
               "time limit of " + files::formatNumber(options_.time_limit_s) + " s of the robot's time");
  blind_s_ = seesNothing(scan) ? blind_s_ + task_.period_s : 0;
  if (blind_s_ > kMostBlind_s) return end(GoalStatus::kGaveUp, "no valid reading for 5 s");
  if (standsStill(T_odom_robot)) return end(GoalStatus::kGaveUp, "no way from this spot for a minute");
  if (look_first_) {
    if (const auto command = look_first_->looking()) return goOn(*command);
  } else if (blind_s_ > 0) {
    return goOn(surroundings_.stand());
  }
  last_ = plan(scan, T_odom_robot);
  if (last_.status != GoalStatus::kMoving) last_.command = surroundings_.stand();
  if (look_first_)
    if (const auto command = look_first_->instead(last_.command)) last_.command = *command;
  last_speed_mps_ = last_.command.speed_mps;
  return last_;
}

}  // namespace slam::goals
