#include "libslam/goals/surroundings.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libslam/core/elementary.h"

namespace slam::goals {
namespace {

constexpr double kGuardMargin_m = 0.02;
constexpr double kTurnInPlace_rad = core::degToRad(25);
constexpr double kArcStep_m = 0.02;
constexpr size_t kMostFelt = 2000;

}  // namespace

Surroundings::Surroundings(const robot::RobotOptions& robot, double clearance_m, double period_s,
                           const std::string& memory, const obstacles::LocalObstacleOptions& zone)
    : robot_(robot),
      clearance_m_(clearance_m),
      period_s_(period_s),
      guard_m_(robot::circumscribedRadius(robot) + kGuardMargin_m),
      memory_(safety::makeObstacleMemory(memory, zone)) {}

void Surroundings::update(const lidar::Scan& scan, const core::Pose2& T_odom_robot) {
  guard_m_ = robot::circumscribedRadius(robot_) + kGuardMargin_m + scan.range_sigma_m;
  memory_->update(scan, T_odom_robot);
  points_ = lidar::scanPoints(scan);
  for (const auto& p_robot : memory_->points()) points_.push_back(p_robot);
  const core::Pose2 T_robot_odom = core::inverse(T_odom_robot);
  for (const auto& p_odom : felt_odom_) points_.push_back(T_robot_odom * p_odom);
}

void Surroundings::add(const std::vector<core::Point2>& p_robot) {
  points_.insert(points_.end(), p_robot.begin(), p_robot.end());
}

void Surroundings::feel(const core::Pose2& T_odom_robot, bool ahead) {
  if (felt_odom_.size() >= kMostFelt) return;
  const double radius_m = robot::circumscribedRadius(robot_);
  felt_odom_.push_back(T_odom_robot * core::Point2{ahead ? radius_m : -radius_m, 0});
  points_.push_back({ahead ? radius_m : -radius_m, 0});
}

Surroundings::Way Surroundings::way(double direction_rad, double radius_m) const {
  const auto [s, c] = core::sinCos(direction_rad);
  Way way{std::numeric_limits<double>::infinity(), std::nullopt};
  for (const auto& point : points_) {
    const double ahead_m = c * point.x + s * point.y;
    const double aside_m = c * point.y - s * point.x;
    if (ahead_m <= 0 || std::abs(aside_m) >= radius_m) continue;
    const double free_m = std::max(0.0, ahead_m - std::sqrt(radius_m * radius_m - aside_m * aside_m));
    if (free_m < way.free_m) way = {free_m, point};
  }
  return way;
}

double Surroundings::nearest_m() const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& p : points_) nearest = std::min(nearest, p.x * p.x + p.y * p.y);
  return std::sqrt(nearest);
}

std::optional<core::Point2> Surroundings::nearestWithin(double most_m) const {
  std::optional<core::Point2> nearest;
  for (const auto& p : points_) {
    const double distance_m = core::hypot(p.x, p.y);
    if (distance_m <= most_m) most_m = distance_m, nearest = p;
  }
  return nearest;
}

bool Surroundings::staysClear(const robot::Command& command) const {
  const double travel_m = std::abs(command.speed_mps) * command.duration_s;
  const int checks = static_cast<int>(std::ceil(travel_m / kArcStep_m));
  for (const auto& p : points_) {
    const double now_m = core::hypot(p.x, p.y);
    if (now_m > guard_m_ + travel_m) continue;
    const double least_m = std::min(guard_m_, now_m) - 1e-6;
    for (int i = 1; i <= checks; ++i) {
      const core::Pose2 T_now_then = robot::driveMotion(command, command.duration_s * i / checks);
      if (core::hypot(p.x - T_now_then.x, p.y - T_now_then.y) < least_m) return false;
    }
  }
  return true;
}

robot::Command Surroundings::guarded(robot::Command command) const {
  const double wanted_mps = command.speed_mps;
  for (const double share : {1.0, 0.75, 0.5, 0.25, 0.1}) {
    command.speed_mps = share * wanted_mps;
    if (staysClear(command)) return command;
  }
  command.speed_mps = 0;
  return command;
}

robot::Command Surroundings::towards(double direction_rad, double most_m) const {
  const double aside_rad = core::wrapToPi(direction_rad);
  if (std::abs(aside_rad) > kTurnInPlace_rad) return turn(aside_rad);
  robot::Command command = turn(aside_rad);
  command.speed_mps = std::min(step_m(), most_m) / period_s_;
  return guarded(command);
}

robot::Command Surroundings::turn(double angle_rad) const {
  const double most_rad = robot_.max_turn_rate_radps * period_s_;
  return {0, std::clamp(angle_rad, -most_rad, most_rad) / period_s_, period_s_};
}

robot::Command Surroundings::straight(double distance_m) const {
  const double most_m = step_m();
  return guarded({std::clamp(distance_m, -most_m, most_m) / period_s_, 0, period_s_});
}

double Surroundings::step_m() const {
  // A step much longer than the clearance would cut what lies between two looks.
  return std::min(robot_.max_speed_mps * period_s_, 0.12);
}

}  // namespace slam::goals
