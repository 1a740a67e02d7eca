#include "libslam/sim/simulator.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/error.h"
#include "libslam/files/parameters.h"
#include "libslam/sim/carry_place.h"
#include "libslam/sim/standing_room.h"

namespace slam::sim {
namespace {

constexpr double kContactTolerance_m = 0.001;
constexpr double kTouching_m = 0.01;  // more than the contact's tolerance

void requireValid(const robot::Command& command) {
  const bool finite = std::isfinite(command.speed_mps) && std::isfinite(command.turn_rate_radps) &&
                      std::isfinite(command.duration_s);
  if (!finite || command.duration_s < 0)
    throw core::ContractError("Simulator::step: expected a finite command with a duration of at least 0");
}

std::optional<lidar::Sweep> statedSweep(const lidar::LidarOptions& lidar) {
  if (!(lidar.sweep > 0)) return std::nullopt;
  return lidar::sweepOf(lidar);
}

}  // namespace

Simulator::Simulator(const world::Plan& plan, const robot::RobotOptions& robot,
                     const lidar::LidarOptions& lidar, const robot::OdometryOptions& odometry,
                     const core::Pose2& start, std::uint64_t seed, double start_time_s,
                     const movers::LivingOptions& living, const std::optional<robot::FloorCamera>& camera)
    : scene_(plan, living, seed, {core::position(start), robot::circumscribedRadius(robot)}),
      robot_(robot),
      lidar_(lidar, seed),
      sweep_(camera ? std::nullopt : statedSweep(lidar)),
      odometer_(odometry, seed),
      path_(lidar_.memory_s()),
      T_world_robot_(start),
      start_time_s_(start_time_s),
      carry_random_(seed, "carry") {
  if (camera) camera_.emplace(*camera, seed);
  requireStandingRoom(plan, "start pose", start, robot::circumscribedRadius(robot_));
}

void Simulator::mount(const NamedLidar& lidar, std::uint64_t seed) {
  others_.push_back(
      {lidar.label, statedSweep(lidar.options), LidarSensor(lidar.options, seed, "lidar " + lidar.label)});
  double memory_s = lidar_.memory_s();
  for (const auto& other : others_) memory_s = std::max(memory_s, other.sensor.memory_s());
  path_ = RecentPath(memory_s);
}

double Simulator::time_s() const {
  return start_time_s_ + static_cast<double>(elapsed_ns_) * 1e-9;
}

Sensed Simulator::sense() {
  Sensed sensed;
  sensed.scan = camera_ ? camera_->sense(scene_, T_world_robot_, time_s())
                        : lidar_.sense(scene_, T_world_robot_, path_, time_s());
  sensed.T_odom_robot = T_odom_robot_;
  sensed.T_previous_robot = T_previous_robot_;
  sensed.collided = collided_;
  sensed.sweep = sweep_;
  for (auto& other : others_)
    sensed.others.push_back(
        {other.label, other.sensor.sense(scene_, T_world_robot_, path_, time_s()), other.sweep});
  return sensed;
}

Sensed Simulator::step(const robot::Command& command) {
  drive(command);
  return sense();
}

void Simulator::drive(const robot::Command& command) {
  requireValid(command);
  const std::int64_t end_ns = elapsed_ns_ + std::llround(command.duration_s * 1e9);
  collided_ = false;
  carryIfDue();
  robot::Command rest = command;
  double driven_s = 0;
  const auto driveOn = [&](const robot::Command& part) {
    const bool is_over = collided_;
    const double part_s = advance(is_over ? robot::Command{0, 0, part.duration_s} : part);
    if (!is_over) driven_s += part_s;
  };
  while (!pending_carries_.empty() && pending_carries_.front().time_ns > elapsed_ns_ &&
         pending_carries_.front().time_ns <= end_ns) {
    rest.duration_s = static_cast<double>(pending_carries_.front().time_ns - elapsed_ns_) * 1e-9;
    driveOn(rest);
    carryIfDue();
    rest.duration_s = static_cast<double>(end_ns - elapsed_ns_) * 1e-9;
  }
  driveOn(rest);
  T_previous_robot_ =
      odometer_.update({command.speed_mps, command.turn_rate_radps, driven_s}, command.duration_s);
  T_odom_robot_ = T_odom_robot_ * T_previous_robot_;
}

double Simulator::advance(const robot::Command& command) {
  const double driven_s =
      scene_.isAlive() ? driveInLivingWorld(command) : freeDuration(command, 0, command.duration_s);
  const robot::Command driven{command.speed_mps, command.turn_rate_radps, driven_s};
  path_.add(T_world_robot_, driven, command.duration_s);
  T_world_robot_ = T_world_robot_ * robot::driveMotion(driven);
  if (driven_s < command.duration_s) {
    collided_ = true;
    const bool with_robot =
        scene_.touchesRobot(core::position(T_world_robot_), robot::circumscribedRadius(robot_) + kTouching_m);
    collisions_.push_back({time_s() + driven_s, T_world_robot_, with_robot});
  }
  elapsed_ns_ += std::llround(command.duration_s * 1e9);
  if (!pending_carries_.empty()) visited_.push_back(core::position(T_world_robot_));
  return driven_s;
}

void Simulator::carryAt(const std::vector<CarryOrder>& orders) {
  const double radius_m = robot::circumscribedRadius(robot_);
  for (const auto& order : orders) {
    if (order.where == CarryOrder::Where::kGiven)
      requireStandingRoom(scene_.planWithDoorsOpen(),
                          order.origin + ": the place at " + files::formatNumber(order.time_s) + " s",
                          order.T_world_robot, radius_m);
    pending_carries_.push_back({std::llround(order.time_s * 1e9), order.T_world_robot, order.where});
  }
}

void Simulator::carryNow(const core::Pose2& T_world_robot) {
  const auto later = std::find_if(pending_carries_.begin(), pending_carries_.end(),
                                  [this](const PendingCarry& carry) { return carry.time_ns > elapsed_ns_; });
  pending_carries_.insert(pending_carries_.erase(pending_carries_.begin(), later),
                          {elapsed_ns_, T_world_robot, CarryOrder::Where::kGiven});
}

core::Pose2 Simulator::placeOf(const PendingCarry& carry) {
  const double radius_m = robot::circumscribedRadius(robot_);
  std::optional<core::Pose2> place;
  if (carry.where == CarryOrder::Where::kRandom)
    place = randomPlace(scene_.planWithDoorsOpen(), T_world_robot_, radius_m, carry_random_);
  if (carry.where == CarryOrder::Where::kVisited)
    place = sim::placeOf(visited_, T_world_robot_, carry_random_);
  if (carry.where == CarryOrder::Where::kGiven) place = carry.T_world_robot;
  return place.value_or(T_world_robot_);
}

void Simulator::carryIfDue() {
  const double radius_m = robot::circumscribedRadius(robot_);
  while (!pending_carries_.empty() && pending_carries_.front().time_ns <= elapsed_ns_) {
    const core::Pose2 T_world_to = placeOf(pending_carries_.front());
    if (scene_.discCollides(core::position(T_world_to), radius_m)) return;
    pending_carries_.erase(pending_carries_.begin());
    carries_.push_back({time_s(), T_world_robot_, T_world_to});
    T_world_robot_ = T_world_to;
    scene_.noteCarried({core::position(T_world_to), radius_m});
  }
}

double Simulator::driveInLivingWorld(const robot::Command& command) {
  const double radius_m = robot::circumscribedRadius(robot_);
  const std::int64_t end_ns = elapsed_ns_ + std::llround(command.duration_s * 1e9);
  double driven_s = 0;
  bool is_free = true;
  const auto driveTo = [&](double to_s) {
    if (!is_free) return;
    driven_s = freeDuration(command, driven_s, to_s);
    is_free = driven_s >= to_s;
  };
  for (std::int64_t tick_ns = (elapsed_ns_ / movers::kTick_ns + 1) * movers::kTick_ns; tick_ns <= end_ns;
       tick_ns += movers::kTick_ns) {
    driveTo(std::min(command.duration_s, static_cast<double>(tick_ns - elapsed_ns_) * 1e-9));
    scene_.tick({core::position(T_world_robot_ * robot::driveMotion(command, driven_s)), radius_m});
  }
  driveTo(command.duration_s);
  return driven_s;
}

double Simulator::freeDuration(const robot::Command& command, double from_s, double to_s) const {
  const double travel_m = std::abs(command.speed_mps) * (to_s - from_s);
  if (travel_m == 0) return to_s;
  const double radius_m = robot::circumscribedRadius(robot_);
  const auto collidesAfter = [&](double elapsed_s) {
    const core::Pose2 T_world_then = T_world_robot_ * robot::driveMotion(command, elapsed_s);
    return scene_.discCollides(core::position(T_world_then), radius_m);
  };
  const int checks =
      static_cast<int>(std::ceil(travel_m / std::min(0.25 * scene_.plan().resolution_m, 0.01)));
  double free_s = from_s;
  for (int i = 1; i <= checks; ++i) {
    double blocked_s = from_s + (to_s - from_s) * i / checks;
    if (!collidesAfter(blocked_s)) {
      free_s = blocked_s;
      continue;
    }
    while ((blocked_s - free_s) * std::abs(command.speed_mps) > kContactTolerance_m) {
      const double middle_s = 0.5 * (free_s + blocked_s);
      (collidesAfter(middle_s) ? blocked_s : free_s) = middle_s;
    }
    return free_s;
  }
  return to_s;
}

}  // namespace slam::sim
