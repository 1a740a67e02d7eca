#include "libslam/explore/exploring_robot.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libslam/navigate/return_to_start.h"
#include "libslam/record/sensor.h"
#include "libslam/robot/drive.h"
#include "libslam/threads/cpu_time.h"

namespace slam::explore {
namespace {

constexpr int kReturnDecisions = 50;  // a way back through a known map takes a few

bool areSame(const std::vector<core::Point2>& a, const std::vector<core::Point2>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const core::Point2& p, const core::Point2& q) { return p.x == q.x && p.y == q.y; });
}

/// All that is written of them is the same.
bool isSame(const choices::Decision& a, const choices::Decision& b) {
  return a.turn_rad == b.turn_rad && a.distance_m == b.distance_m && a.score == b.score &&
         a.finished == b.finished && a.reason == b.reason && areSame(a.path, b.path) &&
         areSame(a.alternatives, b.alternatives);
}

}  // namespace

ExploringRobot::ExploringRobot(const world::Plan& plan, const ExploreConfig& config, const LoopMethod& method,
                               std::uint64_t seed, Place place, const std::string& folder)
    : plan_(plan),
      config_(config),
      method_(method),
      seed_(seed),
      folder_(folder),
      start_(place.T_world_start),
      radius_m_(robot::circumscribedRadius(config.record.robot)),
      simulator_(plan, config.record.robot, config.record.lidar, config.record.odometry, start_, seed,
                 sim::Simulator::kStartTime_s, config.record.living, config.record.camera),
      localiser_(method, seed),
      driver_(makeDriver()),
      coverage_(plan, std::move(place.area)),
      near_misses_(plan, radius_m_),
      start_time_s_(simulator_.time_s()) {
  simulator_.carryAt(config.record.carries);
  for (const auto& lidar : config.record.other_lidars) simulator_.mount(lidar, seed);
  if (!folder.empty()) recorder_.emplace(folder + "/run.rawlog", config.record);
}

std::unique_ptr<navigate::Driver> ExploringRobot::makeDriver() const {
  const auto& record = config_.record;
  const core::RandomStream random(seed_, "strategy");
  auto strategy = config_.own ? config_.own->make(record.strategy, random)
                              : strategies::makeStrategy(record.strategy, random);
  return std::make_unique<navigate::Driver>(std::move(strategy), record.strategy, record.robot, period_s(),
                                            core::RandomStream(seed_, "driver"));
}

void ExploringRobot::startReturn() {
  auto options = config_.record.strategy;
  options.give_up_after = kReturnDecisions;  // the map does not grow on the way back
  driver_ = std::make_unique<navigate::Driver>(
      std::make_unique<navigate::ReturnToStart>(options, config_.record.robot), options, config_.record.robot,
      period_s(), core::RandomStream(seed_, "return"));
  returning_ = true;
}

void ExploringRobot::begin() {
  sensed_ = simulator_.sense();
  if (recorder_) recorder_->begin(simulator_, sensed_);
}

double ExploringRobot::elapsed_s() const {
  // The clock counts nanoseconds, but since the epoch a double is good for a quarter of a microsecond.
  return std::round((simulator_.time_s() - start_time_s_) * 1e6) / 1e6;
}

void ExploringRobot::locate() {
  const auto& scan = sensed_.scan;
  const auto& T_world_robot = simulator_.truth();
  T_map_robot_ = localiser_.update(sensed_, T_world_robot);
  if (!first_scan_) first_scan_ = scan;
  last_scan_ = scan;
  path_.add(T_world_robot, simulator_.carries());
  truth_.push_back({simulator_.time_s(), T_world_robot});
  estimate_.push_back({scan.time_s, T_map_robot_});
  const auto [first_angle_rad, beams] = record::beamsOverFloor(config_.record.camera, scan);
  coverage_.look(T_world_robot * scan.T_robot_lidar, first_angle_rad, scan.step_rad, beams, scan.max_range_m);
  curve_.push_back({elapsed_s(), path_.length_m(), truth_.size(), coverage_.area_m2()});
  near_misses_.look(T_world_robot);
  saw_something_ = saw_something_ || std::any_of(scan.ranges_m.begin(), scan.ranges_m.end(),
                                                 [](float range) { return lidar::isReturn(range); });
}

robot::Command ExploringRobot::decide(const gridmap::OccupancyRaster* map) {
  const double before_s = threads::cpuSeconds();
  if (driver_->wantsMap()) {
    if (map)
      driver_->setMap(*map);
    else
      driver_->setMap(localiser_.map());
  }
  if (const auto spread_m = localiser_.spread_m()) driver_->setSpread(*spread_m);
  const auto command = driver_->next(sensed_.scan, T_map_robot_, sensed_.collided);
  const auto& decision = driver_->currentDecision();
  if (decisions_.empty() || !isSame(decision, decisions_.back().decision)) {
    decisions_.push_back({elapsed_s(), T_map_robot_, simulator_.truth(), decision});
    const double ms = (threads::cpuSeconds() - before_s) * 1000;
    decisions_ms_ += ms;
    slowest_decision_ms_ = std::max(slowest_decision_ms_, ms);
  }
  goals_.push_back(goalInMap(decisions_.back()));
  return command;
}

void ExploringRobot::watch() {
  driver_->watch(sensed_.scan, T_map_robot_);
  goals_.push_back(core::position(T_map_robot_));
}

void ExploringRobot::show(record::StepObserver& observer) const {
  observer.onStep({elapsed_s(), sensed_.scan, sensed_.T_previous_robot, T_map_robot_, &localiser_.builder(),
                   &simulator_, &driver_->currentDecision()});
}

void ExploringRobot::drive(const robot::Command& command) {
  localiser_.tell(command);
  simulator_.drive(command);
}

void ExploringRobot::look(const robot::Command& command) {
  sensed_ = simulator_.sense();
  if (recorder_) recorder_->add(command, simulator_, sensed_);
}

void ExploringRobot::carryOut(const robot::Command& command) {
  drive(command);
  look(command);
}

void ExploringRobot::leaveOut(const std::vector<movers::Disc>& discs_robot) {
  auto& scan = sensed_.scan;
  if (discs_robot.empty()) return;
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    if (!lidar::isReturn(scan.ranges_m[beam])) continue;
    const core::Point2 p_robot =
        scan.T_robot_lidar * core::polar(static_cast<double>(scan.ranges_m[beam]), scan.angle(beam));
    for (const auto& disc : discs_robot)
      if (core::distance(disc.p, p_robot) < disc.radius_m) scan.ranges_m[beam] = lidar::kLostReading;
  }
}

void ExploringRobot::end(ExplorationEnd end) {
  if (end_ != ExplorationEnd::kFailed) return;
  end_ = end;
  if (end == ExplorationEnd::kFinished) end_detail_ = driver_->currentDecision().reason;
  explored_scans_ = curve_.size();
}

void ExploringRobot::fail(const core::MethodError& error) {
  stop_ = {results::Stop::Reason::kFailed, static_cast<int>(estimate_.size()),
           simulator_.time_s() - start_time_s_, error.what()};
  end_ = ExplorationEnd::kFailed;
  end_detail_ = results::stopText(*stop_);
}

}  // namespace slam::explore
