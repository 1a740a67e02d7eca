#include "libslam/goals/lidar_bug.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"

namespace slam::goals {
namespace {

using State = LidarBugState;
using Event = LidarBugEvent;

constexpr int kOriginalReadings = 275;
constexpr std::array<int, 5> kOriginalIndices = {0, 28, 68, 207, 247};
constexpr double kInFront_rad = core::degToRad(92);
// A strategic direction is one reading; where it is lost, the nearest one within this.
constexpr double kNeighbour_rad = core::degToRad(3);
constexpr double kProbe_m = 0.05;  // half of what remembered points may leave open between them
constexpr double kFacing_rad = core::degToRad(3);
constexpr double kStopMargin_m = 0.03;
constexpr double kBumpsForgotten_m = 0.5;
constexpr int kDecisionsPerPeriod = 4;

}  // namespace

std::array<double, 5> strategicDirections() {
  std::array<double, 5> directions{};
  for (size_t i = 0; i < directions.size(); ++i)
    directions[i] = core::wrapToPi(2 * core::kPi * kOriginalIndices[i] / kOriginalReadings);
  return directions;
}

LidarBug::LidarBug(const NavigateOptions& options, const GoalTask& task) : GuardedNavigator(options, task) {}

double lidarBugStopRadius(const LidarBugOptions& options, double guard_m) {
  return std::max(options.stop_radius_m, guard_m + kStopMargin_m);
}

void LidarBug::look(const lidar::Scan& scan, const core::Pose2& T_odom_robot) {
  const double invalid_m = options_.lidar_bug.invalid_below_m;
  const auto directions = strategicDirections();
  std::array<double, 5> aside_rad;
  aside_rad.fill(kNeighbour_rad);
  readings_m_.fill(std::numeric_limits<double>::infinity());
  bump_range_m_ = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const float range_m = scan.ranges_m[i];
    const bool is_return = lidar::isReturn(range_m) && range_m >= invalid_m;
    if (!is_return && range_m != lidar::kNoReturn) continue;
    const double beam_rad = scan.angle(i);
    core::Point2 p_robot = core::polar(range_m, beam_rad);
    if (is_return) p_robot = scan.T_robot_lidar * p_robot;
    const double bearing_rad =
        is_return ? core::atan2(p_robot.y, p_robot.x) : beam_rad + scan.T_robot_lidar.phi;
    const double from_robot_m = is_return ? core::hypot(p_robot.x, p_robot.y) : range_m;
    if (from_robot_m < bump_range_m_) bump_range_m_ = from_robot_m, bump_bearing_rad_ = bearing_rad;
    for (size_t d = 0; d < directions.size(); ++d) {
      const double from_rad = std::abs(core::angleDifference(bearing_rad, directions[d]));
      if (from_rad < aside_rad[d]) aside_rad[d] = from_rad, readings_m_[d] = from_robot_m;
    }
  }
  recall(aside_rad);
  // Capped: where a direction is open, one stride that way decides, not how far the room is.
  const double stride_m = 2 * options_.lidar_bug.clear_front_m;
  for (size_t d = 0; d < directions.size(); ++d) {
    const double r = std::min(readings_m_[d], stride_m);
    p_robot_projected_[d] = core::polar(r, directions[d]);
    p_odom_projected_[d] = T_odom_robot * p_robot_projected_[d];
  }
}

/// With a narrow view: where the sensor does not look or shows nothing, what is known from before stands for
/// the reading.
void LidarBug::recall(const std::array<double, 5>& aside_rad) {
  if (!looksFirst()) return;
  const auto directions = strategicDirections();
  for (size_t d = 0; d < directions.size(); ++d)
    if (aside_rad[d] >= kNeighbour_rad)
      readings_m_[d] = surroundings_.way(directions[d], kProbe_m).free_m + kProbe_m;
  for (const auto& p_robot : surroundings_.points()) {
    const double from_robot_m = core::hypot(p_robot.x, p_robot.y);
    if (from_robot_m < bump_range_m_)
      bump_range_m_ = from_robot_m, bump_bearing_rad_ = core::atan2(p_robot.y, p_robot.x);
  }
}

bool LidarBug::frontClear(double limit_m) const {
  const double oblique_m = 0.75 * limit_m;
  return readings_m_[kAhead] >= limit_m && readings_m_[kLeftAhead] >= oblique_m &&
         readings_m_[kRightAhead] >= oblique_m &&
         surroundings_.way(0, surroundings_.guardRadius()).free_m >= limit_m - stopRadius();
}

bool LidarBug::obstacleInRange() const {
  const auto& o = options_.lidar_bug;
  const bool ahead = readings_m_[kAhead] < o.obstacle_range_m;
  const bool oblique =
      std::min(readings_m_[kLeftAhead], readings_m_[kRightAhead]) < 0.75 * o.obstacle_range_m;
  const bool beside =
      state_ == State::kDriveForward && std::min(readings_m_[kLeft], readings_m_[kRight]) < o.side_range_m;
  return ahead || oblique || beside;
}

bool LidarBug::isDriving() const {
  switch (state_) {
    case State::kDriveForward:
    case State::kDriveAtGoal:
    case State::kAvoidDrive:
    case State::kWallFollow:
    case State::kOpenDrive:
    case State::kStuckReturn:
      return true;
    default:
      return false;
  }
}

double LidarBug::travelled(const core::Pose2& T_odom_robot) const {
  return core::distance(T_odom_remembered_, T_odom_robot);
}

/// The side with room, of two with room the one whose projected place is nearer to the goal.
double LidarBug::chooseTurn() const {
  const auto room = [&](StrategicDirection oblique, StrategicDirection side) {
    return std::min(readings_m_[oblique], readings_m_[side]) >= options_.lidar_bug.side_range_m;
  };
  const bool left = room(kLeftAhead, kLeft), right = room(kRightAhead, kRight);
  if (left != right) return left ? 1 : -1;
  const auto toGoal = [&](StrategicDirection d) {
    return core::distance(p_odom_projected_[d], task_.p_odom_goal);
  };
  return toGoal(kLeft) <= toGoal(kRight) ? 1 : -1;
}

void LidarBug::fire(Event event, const core::Pose2& T_odom_robot, const std::string& detail) {
  const auto& rows = lidarBugTransitions();
  const auto row = std::find_if(rows.begin(), rows.end(), [&](const LidarBugTransition& t) {
    return t.from == state_ && t.event == event;
  });
  if (row == rows.end())
    throw core::ContractError(std::string("LidarBug: no transition from ") + lidarBugStateName(state_) +
                              " on " + lidarBugEventName(event));
  const State from = state_;
  state_ = row->to;
  reason_ = lidarBugEventName(event) + (detail.empty() ? "" : ": " + detail);
  changes_.push_back({lidarBugStateName(from), lidarBugStateName(state_), reason_});
  T_odom_remembered_ = T_odom_robot;
  last_heading_rad_ = T_odom_robot.phi;
  turned_rad_ = 0;
  if (state_ == State::kAvoidTurn || state_ == State::kStuckClear) turn_sign_ = chooseTurn();
  if (state_ == State::kOpenTurn) turn_sign_ = goalDirection(T_odom_robot) >= 0 ? 1 : -1;
  if (state_ == State::kStuckTurn) turn_sign_ = bump_bearing_rad_ >= 0 ? -1 : 1;
}

bool LidarBug::decideDriving(const core::Pose2& T_odom_robot) {
  const auto& o = options_.lidar_bug;
  if (bump_range_m_ < stopRadius()) {
    bumps_in_a_row_ =
        core::distance(T_odom_bump_, T_odom_robot) < kBumpsForgotten_m ? bumps_in_a_row_ + 1 : 1;
    T_odom_bump_ = T_odom_robot;
    bump_in_front_ = std::abs(core::wrapToPi(bump_bearing_rad_)) <= kInFront_rad;
    const bool many = bumps_in_a_row_ >= o.bumps_in_a_row;
    fire(many ? Event::kManyBumps : Event::kBump, T_odom_robot,
         files::formatNumber(std::round(100 * bump_range_m_) / 100) + " m at " +
             files::formatNumber(std::round(core::radToDeg(bump_bearing_rad_))) + " deg, " +
             (bump_in_front_ ? "in front" : "behind"));
    if (many) bumps_in_a_row_ = 0;
    return true;
  }
  const bool near = goalDistance(T_odom_robot) < o.near_goal_m &&
                    surroundings_.way(goalDirection(T_odom_robot), stopRadius()).free_m >=
                        goalDistance(T_odom_robot) - options_.goal_tolerance_m;
  const bool may_aim = state_ == State::kDriveForward || state_ == State::kWallFollow;
  const bool moved = travelled(T_odom_robot) >= o.drive_on_m;
  if (may_aim && near) return fire(Event::kGoalNear, T_odom_robot, ""), true;
  if (state_ == State::kDriveAtGoal) {
    if (!near) return fire(Event::kGoalFar, T_odom_robot, "or its way is blocked"), true;
    return false;
  }
  if (state_ == State::kStuckReturn) {
    if (moved) return fire(Event::kReturned, T_odom_robot, ""), true;
    return false;
  }
  if (obstacleInRange()) return fire(Event::kObstacleInRange, T_odom_robot, ""), true;
  switch (state_) {
    case State::kDriveForward:
      if (std::abs(goalDirection(T_odom_robot)) > o.off_course_rad)
        return fire(Event::kOffCourse, T_odom_robot, ""), true;
      return false;
    case State::kAvoidDrive:
    case State::kOpenDrive:
      if (moved) return fire(Event::kDrivenOn, T_odom_robot, ""), true;
      return false;
    default:
      if (std::min(readings_m_[kLeft], readings_m_[kRight]) > o.wall_lost_m)
        return fire(Event::kSidesOpen, T_odom_robot, ""), true;
      return false;
  }
}

bool LidarBug::decideTurning(const core::Pose2& T_odom_robot) {
  if (state_ == State::kTurnToGoal) {
    if (goalDistance(T_odom_robot) < options_.lidar_bug.near_goal_m &&
        surroundings_.way(goalDirection(T_odom_robot), stopRadius()).free_m >=
            goalDistance(T_odom_robot) - options_.goal_tolerance_m)
      return fire(Event::kGoalNear, T_odom_robot, ""), true;
    if (std::abs(goalDirection(T_odom_robot)) > kFacing_rad) return false;
    return fire(Event::kFacingGoal, T_odom_robot, ""), true;
  }
  const double limit_m = options_.lidar_bug.clear_front_m * (state_ == State::kStuckClear ? 1.5 : 1.0);
  // At a wall's end the front is mostly clear at once: ours asks for the goal's side.
  const bool asks_goal_side = state_ == State::kOpenTurn && options_.lidar_bug.wall_end == "goal";
  const bool to_goal = !asks_goal_side || goalDirection(T_odom_robot) * turn_sign_ < kFacing_rad;
  if (to_goal && frontClear(limit_m)) return fire(Event::kFrontClear, T_odom_robot, ""), true;
  if (std::abs(turned_rad_) < 2 * core::kPi + 0.2) return false;
  fire(Event::kNoClearFront, T_odom_robot, "in a full turn");
  return true;
}

bool LidarBug::decideStuck(const core::Pose2& T_odom_robot) {
  const auto& o = options_.lidar_bug;
  if (state_ == State::kStuckLeave) {
    const double way_rad = bump_in_front_ ? core::kPi : 0;
    const bool blocked = surroundings_.way(way_rad, surroundings_.guardRadius()).free_m < 0.01;
    if (!blocked && travelled(T_odom_robot) < o.back_off_m) return false;
    fire(Event::kMovedAway, T_odom_robot, blocked ? "as far as the way was free" : "");
    return true;
  }
  if (std::abs(turned_rad_) < o.stuck_turn_rad) return false;
  fire(Event::kTurnedAway, T_odom_robot, "");
  return true;
}

bool LidarBug::decide(const core::Pose2& T_odom_robot) {
  if (isDriving()) return decideDriving(T_odom_robot);
  switch (state_) {
    case State::kStuckLeave:
    case State::kStuckTurn:
      return decideStuck(T_odom_robot);
    case State::kReached:
    case State::kGaveUp:
      return false;
    default:
      return decideTurning(T_odom_robot);
  }
}

GoalStep LidarBug::plan(const lidar::Scan& scan, const core::Pose2& T_odom_robot) {
  look(scan, T_odom_robot);
  changes_.clear();
  turned_rad_ += core::angleDifference(T_odom_robot.phi, last_heading_rad_);
  last_heading_rad_ = T_odom_robot.phi;
  for (int i = 0; i < kDecisionsPerPeriod && decide(T_odom_robot); ++i) {
  }
  const GoalStatus status = state_ == State::kGaveUp ? GoalStatus::kGaveUp : GoalStatus::kMoving;
  return {act(T_odom_robot), status,   lidarBugStateName(state_),
          reason_,           changes_, {p_robot_projected_.begin(), p_robot_projected_.end()}};
}

std::string LidarBug::endState(GoalStatus status) const {
  return lidarBugStateName(status == GoalStatus::kReached ? State::kReached : State::kGaveUp);
}

robot::Command LidarBug::followWall() const {
  const auto& o = options_.lidar_bug;
  const bool on_left = readings_m_[kLeft] < readings_m_[kRight];
  const double side_m = on_left ? readings_m_[kLeft] : readings_m_[kRight];
  const double oblique_m =
      std::min(on_left ? readings_m_[kLeftAhead] : readings_m_[kRightAhead], 3 * o.wall_lost_m);
  const double oblique_rad = strategicDirections()[kLeftAhead];
  // The wall's slant from the two readings: positive when it leads away from the heading.
  const double slant_rad =
      std::clamp(core::atan2(oblique_m * core::sin(oblique_rad) - side_m, oblique_m * core::cos(oblique_rad)),
                 -0.5, 0.5);
  const double towards_wall_rad = std::clamp(1.5 * (side_m - o.wall_distance_m), -0.3, 0.3) + 0.5 * slant_rad;
  return surroundings_.towards((on_left ? 1 : -1) * std::clamp(towards_wall_rad, -0.35, 0.35),
                               surroundings_.step_m());
}

robot::Command LidarBug::act(const core::Pose2& T_odom_robot) const {
  const double step_m = surroundings_.step_m();
  switch (state_) {
    case State::kTurnToGoal:
      return surroundings_.turn(goalDirection(T_odom_robot));
    case State::kDriveForward:
    case State::kDriveAtGoal:
      return surroundings_.towards(goalDirection(T_odom_robot), goalDistance(T_odom_robot));
    case State::kAvoidDrive:
    case State::kOpenDrive:
    case State::kStuckReturn:
      return surroundings_.straight(step_m);
    case State::kWallFollow:
      return followWall();
    case State::kAvoidTurn:
    case State::kOpenTurn:
    case State::kStuckClear:
      return surroundings_.turn(turn_sign_ * core::degToRad(10));
    case State::kStuckTurn:
      return surroundings_.turn(turn_sign_ *
                                (options_.lidar_bug.stuck_turn_rad - std::abs(turned_rad_) + 0.02));
    case State::kStuckLeave:
      return surroundings_.straight(bump_in_front_ ? -step_m : step_m);
    default:
      return surroundings_.stand();
  }
}

}  // namespace slam::goals
