#include "libslam/plugin/exploring_robot.h"
#include "libslam/navigate/driver.h"

#include <algorithm>

#include "libslam/core/error.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/resources/resources.h"
#include "libslam/run/log_feed.h"
#include "libslam/sim/simulator.h"

namespace slam::plugin {
namespace {

using Options = ExploringRobotOptions;

files::ParameterTable<Options> tableFor(const std::string& section) {
  return {section,
          {{"plan", &Options::plan, "flat", {}, "path, or the name of a world"},
           {"lidar", &Options::lidar, "", {}, "name of a preset, or an .ini file; empty: built-in values"},
           {"strategy", &Options::strategy, "", {}, "where to go; empty: the built-in one"},
           {"slam", &Options::slam, "graph", {}, "method that makes the map, for strategies that need one"},
           {"start", &Options::start, "auto", {}, "auto, or x_m,y_m,yaw_deg in the world frame"},
           {"seed", &Options::seed, 1, 0, 2147483647, "of every random stream"},
           {"scans", &Options::scans, 0, 0, 1000000000, "then silence; 0 = no end"},
           {"real_time_factor", &Options::real_time_factor, 0.0, 0.0, 1000.0,
            "simulated seconds per second; 0 = one scan per call, at process_rate"},
           {"done_file", &Options::done_file, "", {}, "gets a line after the last scan; empty: none"}}};
}

files::IniFile lidarPreset(const std::string& lidar, const std::string& origin) {
  if (lidar.empty()) return {};
  if (lidar.find_first_of("/.") != std::string::npos) return resources::readConfigFile(lidar);
  const std::string folder = resources::configsFolder() + "/lidars";
  const auto names = resources::namesInFolder(folder, ".ini");
  if (std::find(names.begin(), names.end(), lidar) == names.end())
    throw core::InputError(origin + ", key 'lidar': found '" + lidar + "', expected a lidar of " + folder +
                           core::didYouMean(lidar, names));
  return resources::readConfigFile(folder + "/" + lidar + ".ini");
}

std::uint64_t seedOf(const Options& options) {
  return static_cast<std::uint64_t>(options.seed);
}

}  // namespace

Options readExploringRobotOptions(const files::IniFile& ini, const std::string& section) {
  files::IniFile own, dotted;
  if (const auto it = ini.sections().find(section); it != ini.sections().end())
    for (const auto& [key, entry] : it->second) {
      const auto dot = key.find('.');
      if (dot == std::string::npos)
        own.set(section, key, entry.value, entry.origin);
      else
        dotted.set(key.substr(0, dot), key.substr(dot + 1), entry.value, entry.origin);
    }
  const auto table = tableFor(section);
  Options options;
  table.setDefaults(options);
  files::readParameters(own, table, options);

  const std::string origin = "section [" + section + "]";
  files::IniFile record = lidarPreset(options.lidar, origin);
  record.set("simulation", "start", options.start, origin);
  if (!options.strategy.empty()) record.set("strategy", "name", options.strategy, origin);
  record.overrideWith(dotted);
  options.record = record::readRecordConfig(record);
  if (strategies::strategyNeedsMap(options.record.strategy.name))
    mapping::loadMethodConfig(resources::configsFolder() + "/methods",
                              options.slam);  // an unknown one is told now
  return options;
}

struct ExploringRobot::State {
  explicit State(const Options& options)
      : plan(record::planOfVisit(world::loadPlan(resources::resolvePlan(options.plan)), options.record.living,
                                 seedOf(options))),
        simulator(plan, options.record.robot, options.record.lidar, options.record.odometry,
                  record::startPose(plan, options.record), seedOf(options), sim::Simulator::kStartTime_s,
                  options.record.living, options.record.camera),
        driver(strategies::makeStrategy(options.record.strategy, {seedOf(options), "strategy"}),
               options.record.strategy, options.record.robot, 1 / options.record.lidar.rate_hz,
               {seedOf(options), "driver"}),
        scans_left(options.scans > 0 ? options.scans : -1) {
    for (const auto& lidar : options.record.other_lidars) simulator.mount(lidar, seedOf(options));
    if (!strategies::strategyNeedsMap(options.record.strategy.name)) return;
    const auto config = mapping::loadMethodConfig(resources::configsFolder() + "/methods", options.slam);
    slam = mapping::makeMapBuilder(config, options.slam, seedOf(options));
  }

  robot::Command decide() {
    core::Pose2 T_map_robot = sensed->T_odom_robot;
    if (slam) {
      run::tellSensors(*slam, *sensed);
      T_map_robot = mapping::processScan(*slam, sensed->scan, sensed->T_previous_robot, true);
      if (driver.wantsMap()) driver.setMap(mapping::currentMap(*slam));
    }
    return driver.next(sensed->scan, T_map_robot, sensed->collided);
  }

  world::Plan plan;
  sim::Simulator simulator;
  navigate::Driver driver;
  std::optional<mapping::MapBuilder> slam;  ///< none: the strategy needs no map, and odometry is its frame
  int scans_left;                           ///< negative: no end
  std::optional<sim::Sensed> sensed;
  bool finished = false;
};

ExploringRobot::ExploringRobot(const Options& options) : state_(std::make_unique<State>(options)) {}
ExploringRobot::~ExploringRobot() = default;

std::optional<sim::Sensed> ExploringRobot::next() {
  State& s = *state_;
  if (s.finished || s.scans_left == 0) return std::nullopt;
  if (!s.sensed) {
    s.sensed = s.simulator.sense();
  } else {
    const auto command = s.decide();
    s.finished = s.driver.finished();
    if (s.finished) return std::nullopt;
    s.sensed = s.simulator.step(command);
  }
  if (s.scans_left > 0) --s.scans_left;
  return s.sensed;
}

}  // namespace slam::plugin
