#include "libslam/record/record.h"
#include "libslam/navigate/driver.h"

#include <filesystem>

#include "libslam/buildings/furniture.h"
#include "libslam/core/error.h"
#include "libslam/files/word_list.h"
#include "libslam/record/recorder.h"
#include "libslam/record/sensor.h"
#include "libslam/safety/safe_motion.h"

namespace slam::record {

core::Pose2 startPose(const world::Plan& plan, const RecordConfig& config) {
  const double w_m =
      config.strategy.stop_clearance_m > 0
          ? config.strategy.stop_clearance_m
          : safety::stopClearance(config.robot, 1 / config.lidar.rate_hz, config.lidar.sigma_m);
  const double clearance_m = robot::circumscribedRadius(config.robot) + w_m;
  if (config.simulation.start == "auto") {
    if (const auto pose = world::findStartPose(plan, clearance_m)) return *pose;
    if (const auto pose = world::findStartPose(plan, robot::circumscribedRadius(config.robot))) return *pose;
    throw core::InputError(plan.name + ": no free place for a robot of side " +
                           files::formatNumber(config.robot.side_m) + " m");
  }
  const auto numbers = files::parseNumberList(config.simulation.start);
  if (numbers.size() != 3)
    throw core::InputError("section [simulation], key 'start': found '" + config.simulation.start +
                           "', expected auto or x_m,y_m,yaw_deg");
  return {numbers[0], numbers[1], core::wrapToPi(core::degToRad(numbers[2]))};
}

const files::ParameterTable<SimulationOptions>& SimulationOptions::table() {
  using O = SimulationOptions;
  static const files::ParameterTable<O> rows(
      "simulation",
      {{"duration_s", &O::duration_s, 600.0, 0.0, 1e7, "longest recording, in the robot's time"},
       {"start", &O::start, "auto", {}, "auto, or x_m,y_m,yaw_deg in the world frame"},
       {"log_form", &O::log_form, "action", {"action", "observation"}, "form of the rawlog"}});
  return rows;
}

SimulationOptions::SimulationOptions() {
  table().setDefaults(*this);
}

RecordConfig readRecordConfig(const files::IniFile& given, const std::vector<std::string>& other_sections) {
  std::vector<std::string> known = {"robot",  "odometry",   "strategy", "obstacles",
                                    "living", "simulation", "events"};
  const auto sensors = sensorSections(given);
  known.insert(known.end(), sensors.begin(), sensors.end());
  known.insert(known.end(), other_sections.begin(), other_sections.end());
  files::rejectUnknownSections(given, known);
  RecordConfig config;
  auto* report = &config.parameters;
  files::readParameters(given, robot::RobotOptions::table(), config.robot, report);
  const auto sensor = readSensor(given, config.robot, report);
  config.lidar = sensor.lidar, config.camera = sensor.camera, config.other_lidars = sensor.other_lidars;
  const auto ini = withCameraDefaults(given, sensor.camera, config.robot);
  files::readParameters(ini, robot::OdometryOptions::table(), config.odometry, report);
  files::readParameters(ini, strategies::StrategyOptions::table(), config.strategy, report);
  files::readParameters(ini, obstacles::LocalObstacleOptions::table(), config.strategy.obstacles, report);
  files::readParameters(ini, movers::LivingOptions::table(), config.living, report);
  files::readParameters(ini, SimulationOptions::table(), config.simulation, report);
  config.carries = sim::readCarries(ini, report);
  sim::requireBefore(config.carries, config.simulation.duration_s);
  return config;
}

world::Plan planOfVisit(const world::Plan& plan, const movers::LivingOptions& living, std::uint64_t seed) {
  world::Plan found = plan;
  for (int visit = 2; visit <= living.visit; ++visit) {
    core::RandomStream random(seed, "visit " + std::to_string(visit));
    found = buildings::moveFurniture(found, random.bits(), living.furniture_share).plan;
  }
  return found;
}

namespace {

/// The loop of every recording. `decision` tells the observer what the commander follows; nullptr: nothing.
Recording recordLoop(sim::Simulator& simulator, const RecordConfig& config, std::uint64_t seed,
                     const std::string& log_path, resources::Manifest manifest, core::Progress& progress,
                     const Commander& commander, StepObserver* observer,
                     const std::function<const choices::Decision*()>& decision) {
  const double period_s = 1 / config.lidar.rate_hz;
  simulator.carryAt(config.carries);
  for (const auto& lidar : config.other_lidars) simulator.mount(lidar, seed);
  Recorder recorder(log_path, config);
  robot::CommandSeries commands;
  robot::Commanded commanded = robot::MotionKind::kRest;
  progress.begin("simulating " + simulator.scene().plan().name);
  const double start_time_s = simulator.time_s();
  sim::Sensed sensed = simulator.sense();
  recorder.begin(simulator, sensed);
  while (true) {
    const double elapsed_s = simulator.time_s() - start_time_s;
    progress.update(elapsed_s / config.simulation.duration_s, elapsed_s);
    const bool is_over = elapsed_s + period_s / 2 >= config.simulation.duration_s;
    const auto order = is_over ? std::nullopt : commander(sensed);
    if (observer)
      observer->onStep({elapsed_s, sensed.scan, sensed.T_previous_robot, sensed.T_odom_robot, nullptr,
                        &simulator, decision(), "", commanded, &sensed});
    if (!order) break;
    commanded = commands.next(order->command, order->is_whole);
    if (order->T_world_carried) simulator.carryNow(*order->T_world_carried);
    sensed = simulator.step(order->command);
    recorder.add(order->command, simulator, sensed, order->is_whole);
  }
  progress.end();
  return recorder.finish(simulator, seed, std::move(manifest));
}

}  // namespace

Recording record(const world::Plan& given_plan, const RecordConfig& config, std::uint64_t seed,
                 const std::string& log_path, resources::Manifest manifest, core::Progress& progress,
                 StepObserver* observer) {
  const world::Plan plan = planOfVisit(given_plan, config.living, seed);
  sim::Simulator simulator(plan, config.robot, config.lidar, config.odometry, startPose(plan, config), seed,
                           sim::Simulator::kStartTime_s, config.living, config.camera);
  navigate::Driver driver(strategies::makeStrategy(config.strategy, core::RandomStream(seed, "strategy")),
                          config.strategy, config.robot, 1 / config.lidar.rate_hz,
                          core::RandomStream(seed, "driver"));
  if (driver.wantsMap())
    throw core::InputError("strategy '" + config.strategy.name +
                           "' needs a map, and a recording builds none: use 'rasterslam explore'");
  bool has_decided = false;
  const auto drive = [&](const sim::Sensed& sensed) -> std::optional<Order> {
    const auto command = driver.next(sensed.scan, sensed.T_odom_robot, sensed.collided);
    has_decided = true;
    if (driver.finished()) return std::nullopt;
    return command;
  };
  return recordLoop(simulator, config, seed, log_path, std::move(manifest), progress, drive, observer,
                    [&] { return has_decided ? &driver.currentDecision() : nullptr; });
}

Recording recordCommands(const world::Plan& given_plan, const RecordConfig& config, std::uint64_t seed,
                         const std::string& log_path, resources::Manifest manifest, core::Progress& progress,
                         const Commander& commander, StepObserver* observer) {
  const world::Plan plan = planOfVisit(given_plan, config.living, seed);
  sim::Simulator simulator(plan, config.robot, config.lidar, config.odometry, startPose(plan, config), seed,
                           sim::Simulator::kStartTime_s, config.living, config.camera);
  return recordLoop(simulator, config, seed, log_path, std::move(manifest), progress, commander, observer,
                    [] { return nullptr; });
}

}  // namespace slam::record
