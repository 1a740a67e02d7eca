#include "libslam/goals/look_first.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/obstacles/lidar_view.h"

namespace slam::goals {
namespace {

constexpr double kStep_m = 0.02, kTurned_rad = core::degToRad(1);
constexpr size_t kMostHidden = 500;

}  // namespace

LookFirst::LookFirst(const robot::RobotOptions& robot, double period_s,
                     const obstacles::LocalObstacleOptions& zone)
    : robot_(robot), period_s_(period_s), body_m_(robot::circumscribedRadius(robot)), floor_(zone) {}

void LookFirst::update(const lidar::Scan& scan, const core::Pose2& T_odom_robot) {
  lidar::Scan from_sensor = scan;
  from_sensor.min_range_m = 0;
  obstacles::SectorOptions all;
  all.width_rad = 2 * core::kPi, all.reach_m = 0, all.depth_margin_m = 0;
  floor_.update(T_odom_robot, obstacles::LidarView(from_sensor, all), body_m_);
  T_odom_robot_ = T_odom_robot;
  const double last_rad = scan.ranges_m.empty() ? scan.first_angle_rad : scan.angle(scan.ranges_m.size() - 1);
  T_robot_sensor_ = scan.T_robot_lidar * core::Pose2{0, 0, (scan.first_angle_rad + last_rad) / 2};
  half_view_rad_ = (last_rad - scan.first_angle_rad) / 2;
  hidden_odom_.erase(std::remove_if(hidden_odom_.begin(), hidden_odom_.end(),
                                    [this](const core::Point2& p) { return floor_.isSeen(p); }),
                     hidden_odom_.end());
  if (!p_odom_look_) return;
  const bool seen = floor_.isSeen(*p_odom_look_);
  if (!seen && !isFaced(*p_odom_look_)) return;
  if (!seen) hide(*p_odom_look_);
  p_odom_look_.reset();
}

void LookFirst::hide(const core::Point2& p_odom) {
  if (hidden_odom_.size() < kMostHidden) hidden_odom_.push_back(p_odom);
}

bool LookFirst::isFaced(const core::Point2& p_odom) const {
  const core::Point2 p_sensor = core::inverse(T_odom_robot_ * T_robot_sensor_) * p_odom;
  // Well inside of the view, at whose sides a camera sees less far. A sensor beside the centre may never face
  // what is near.
  return std::abs(core::atan2(p_sensor.y, p_sensor.x)) <= half_view_rad_ / 2 ||
         std::abs(rest(p_odom)) < kTurned_rad;
}

double LookFirst::rest(const core::Point2& p_odom) const {
  const core::Point2 p_robot = core::inverse(T_odom_robot_) * p_odom;
  return core::wrapToPi(core::atan2(p_robot.y, p_robot.x) - T_robot_sensor_.phi);
}

std::optional<core::Point2> LookFirst::unseenOn(const robot::Command& command) const {
  const int steps = static_cast<int>(std::ceil(std::abs(command.speed_mps) * command.duration_s / kStep_m));
  for (int i = 1; i <= steps; ++i) {
    const core::Pose2 T_now_then = robot::driveMotion(command, command.duration_s * i / steps);
    const auto unseen = floor_.unseenWithin(core::position(T_odom_robot_ * T_now_then), body_m_,
                                            core::position(T_odom_robot_));
    if (unseen) return unseen;
  }
  return std::nullopt;
}

std::optional<robot::Command> LookFirst::looking() const {
  if (!p_odom_look_) return std::nullopt;
  const double most_rad = robot_.max_turn_rate_radps * period_s_;
  return robot::Command{0, std::clamp(rest(*p_odom_look_), -most_rad, most_rad) / period_s_, period_s_};
}

std::optional<robot::Command> LookFirst::instead(const robot::Command& command) {
  p_odom_look_ = unseenOn(command);
  if (!p_odom_look_) return std::nullopt;
  if (!isFaced(*p_odom_look_)) return looking();
  hide(*p_odom_look_);
  p_odom_look_.reset();
  return robot::Command{0, 0, period_s_};
}

std::vector<core::Point2> LookFirst::hidden() const {
  const core::Pose2 T_robot_odom = core::inverse(T_odom_robot_);
  std::vector<core::Point2> p_robot;
  p_robot.reserve(hidden_odom_.size());
  for (const auto& p_odom : hidden_odom_) p_robot.push_back(T_robot_odom * p_odom);
  return p_robot;
}

}  // namespace slam::goals
