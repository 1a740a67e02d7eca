#include "libslam/run/record.h"

#include <chrono>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/core/files.h"
#include "libslam/logs/log_writer.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/odometry/scan_odometry.h"
#include "libslam/sim/operation_log.h"

namespace slam::run {
namespace {

logs::LogEntry toLogEntry(const sim::Sensed& sensed) {
  return {sensed.scan, sensed.T_odom_robot, sensed.T_previous_robot, true};
}

bool isTurn(const robot::Command& command) {
  return command.speed_mps == 0 && command.turn_rate_radps != 0;
}

sim::Operation toOperation(const robot::Command& command, const odometry::ScanMotion& motion) {
  if (isTurn(command)) return {'t', motion.turn_reading_rad, 0.0};
  return {'m', motion.rear_reading_m, motion.front_reading_m};
}

}  // namespace

core::Pose2 startPose(const world::Plan& plan, const RecordConfig& config) {
  const double clearance_m = robot::circumscribedRadius(config.robot) + config.strategy.stop_clearance_m;
  if (config.simulation.start == "auto") {
    if (const auto pose = world::findStartPose(plan, clearance_m)) return *pose;
    if (const auto pose = world::findStartPose(plan, robot::circumscribedRadius(config.robot))) return *pose;
    throw core::InputError(plan.name + ": no free place for a robot of side " +
                           core::formatNumber(config.robot.side_m) + " m");
  }
  std::istringstream words(config.simulation.start);
  std::string word;
  std::vector<double> numbers;
  for (double number = 0; words >> word;) {
    if (!core::parseNumber(word, number)) break;
    numbers.push_back(number);
    word.clear();
  }
  if (numbers.size() != 3 || !word.empty())
    throw core::InputError("section [simulation], key 'start': found '" + config.simulation.start +
                           "', expected auto or x_m y_m yaw_deg");
  return {numbers[0], numbers[1], core::wrapToPi(core::degToRad(numbers[2]))};
}

const core::ParameterTable<SimulationOptions>& SimulationOptions::table() {
  using O = SimulationOptions;
  static const core::ParameterTable<O> rows(
      "simulation",
      {{"duration_s", &O::duration_s, 600.0, 0.0, 1e7, "longest recording, in the robot's time"},
       {"start", &O::start, "auto", {}, "auto, or x_m y_m yaw_deg in the world frame"},
       {"log_form", &O::log_form, "action", {"action", "observation"}, "form of the rawlog"}});
  return rows;
}

SimulationOptions::SimulationOptions() {
  table().setDefaults(*this);
}

RecordConfig readRecordConfig(const core::IniFile& ini) {
  core::rejectUnknownSections(ini, {"robot", "lidar", "odometry", "strategy", "simulation"});
  RecordConfig config;
  auto* report = &config.parameters;
  core::readParameters(ini, robot::RobotOptions::table(), config.robot, report);
  core::readParameters(ini, robot::LidarOptions::table(), config.lidar, report);
  core::readParameters(ini, robot::OdometryOptions::table(), config.odometry, report);
  core::readParameters(ini, navigate::StrategyOptions::table(), config.strategy, report);
  core::readParameters(ini, SimulationOptions::table(), config.simulation, report);
  return config;
}

std::string logStem(const std::string& log_path) {
  const std::filesystem::path path(log_path);
  return path.extension() == ".rawlog" ? (path.parent_path() / path.stem()).string() : log_path;
}

Recording record(const world::Plan& plan, const RecordConfig& config, std::uint64_t seed,
                 const std::string& log_path, core::Manifest manifest, core::Progress& progress) {
  const auto wall_start = std::chrono::steady_clock::now();
  const double period_s = 1 / config.lidar.rate_hz;
  sim::Simulator simulator(plan, config.robot, config.lidar, config.odometry, startPose(plan, config), seed);
  navigate::Driver driver(navigate::makeStrategy(config.strategy, core::RandomStream(seed, "strategy")),
                          config.strategy, config.robot, period_s, core::RandomStream(seed, "driver"));
  odometry::ScanOdometryOptions founding;
  founding.method = "argmax";
  const auto scan_odometry = odometry::makeScanOdometry(founding);
  logs::LogWriter log(log_path, config.simulation.log_form == "action" ? logs::RawlogForm::kActionFrame
                                                                       : logs::RawlogForm::kObservationOnly);
  Recording recording;
  std::vector<sim::Operation> operations;
  progress.begin("simulating " + plan.name);
  const double start_time_s = simulator.time_s();
  sim::Sensed sensed = simulator.sense();
  scan_odometry->update(sensed.scan);
  while (true) {
    log.write(toLogEntry(sensed));
    recording.truth.push_back({simulator.time_s(), simulator.truth()});
    const double elapsed_s = simulator.time_s() - start_time_s;
    progress.update(elapsed_s / config.simulation.duration_s, elapsed_s);
    if (elapsed_s + period_s / 2 >= config.simulation.duration_s) break;
    const robot::Command command = driver.next(sensed.scan, sensed.T_odom_robot, sensed.collided);
    if (driver.finished()) break;
    sensed = simulator.step(command);
    const auto kind = isTurn(command) ? odometry::MotionKind::kTurn : odometry::MotionKind::kMove;
    operations.push_back(toOperation(command, scan_odometry->update(sensed.scan, kind)));
  }
  progress.end();

  const std::string stem = logStem(log_path);
  log.close();
  logs::writeTum(recording.truth, stem + ".gt.tum");
  logs::writeMrptGroundTruth(recording.truth, log_path + ".GT.txt");
  core::writeFileAtomically(stem + ".operations.txt", sim::formatOperations(operations));
  recording.collisions = simulator.collisions();
  recording.duration_s = simulator.time_s() - start_time_s;
  recording.path_length_m = core::pathLength(recording.truth);
  recording.files = {log_path, log_path + ".GT.txt", stem + ".gt.tum", stem + ".operations.txt",
                     stem + ".manifest.json"};

  manifest.seed = seed;
  for (const auto& line : config.parameters) manifest.config[line.section + "." + line.info.key] = line.value;
  const auto name = [](const std::string& path) { return std::filesystem::path(path).filename().string(); };
  manifest.files[name(log_path)] = "MRPT rawlog: RawLogViewer, rawlog-edit, icp-slam, rasterslam run";
  manifest.files[name(log_path) + ".GT.txt"] =
      "truth, MRPT's text form, relative to the start: graphslam-engine -g";
  manifest.files[name(stem) + ".gt.tum"] = "truth, TUM form, world frame: rasterslam eval --truth, evo";
  manifest.files[name(stem) + ".operations.txt"] =
      "operation log: m rear front (metres) or t angle (radians)";
  manifest.results["scans"] = std::to_string(recording.truth.size());
  manifest.results["duration_s"] = core::formatNumber(recording.duration_s);
  manifest.results["path_length_m"] = core::formatNumber(recording.path_length_m);
  manifest.results["collisions"] = std::to_string(recording.collisions.size());
  manifest.times_s["simulation"] =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_start).count();
  core::writeManifest(manifest, stem + ".manifest.json");
  return recording;
}

}  // namespace slam::run
