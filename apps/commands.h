#pragma once
#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "libslam/files/ini.h"
#include "libslam/files/parameters.h"
#include "libslam/resources/manifest.h"

namespace slam::apps {

/// What every command shares.
struct Context {
  std::vector<std::string> command_line;
  std::function<int()> action;  ///< set by the chosen command; returns the exit code

  std::uint64_t seed = 1;
  std::string output, config;
  std::vector<std::string> settings;  ///< --set
  bool json = false, overwrite = false, quiet = false, print_config = false;

  resources::Manifest manifest() const;
  /// This program's own file, for comparisons that give each method a process.
  std::string programPath() const;
};

void addBench(CLI::App& app, Context& context);
void addData(CLI::App& app, Context& context);
void addDemo(CLI::App& app, Context& context);
void addSimulate(CLI::App& app, Context& context);
void addRun(CLI::App& app, Context& context);
void addEval(CLI::App& app, Context& context);
void addExplore(CLI::App& app, Context& context);
void addCompare(CLI::App& app, Context& context);
void addConvert(CLI::App& app, Context& context);
void addNavigate(CLI::App& app, Context& context);
void addGraph(CLI::App& app, Context& context);
void addInfo(CLI::App& app, Context& context);
void addCheck(CLI::App& app, Context& context);
void addEditing(CLI::App& app, Context& context);  ///< cut, filter
void addMerge(CLI::App& app, Context& context);
void addDiff(CLI::App& app, Context& context);
void addPlot(CLI::App& app, Context& context);
void addPlugin(CLI::App& app, Context& context);
void addStress(CLI::App& app, Context& context);
void addTune(CLI::App& app, Context& context);
void addRelations(CLI::App& app, Context& context);
void addReport(CLI::App& app, Context& context);
void addView(CLI::App& app, Context& context);  ///< hands over to rasterslam-view
void addWorld(CLI::App& app, Context& context);
void addWorldMake(CLI::App& world, Context& context);
void addWorldCheck(CLI::App& world, Context& context);
void addList(CLI::App& app, Context& context);

/// For CLI11: what is wrong with the word of a duration, which is a finite number of seconds from 0 on; ""
/// when nothing is.
std::string isDuration(const std::string& word);

// Options that mean the same wherever they appear.
void addSeed(CLI::App* command, Context& context);
void addOutput(CLI::App* command, Context& context, const std::string& what);
void addConfig(CLI::App* command, Context& context);
void addJson(CLI::App* command, Context& context);

// What is meant where nothing is named.
/// The methods that are compared.
const std::vector<std::string>& defaultMethods();
/// Where an explorer's pose and map come from.
inline constexpr const char* kExplorersSlam = "graph";
/// Where the pose of a robot comes from that drives to a goal: the lidar's own odometry, which has no map and
/// drifts a tenth as much as the wheels.
inline constexpr const char* kNavigatorsSlam = "naive_flow";

/// Flags of a simulation, shared by simulate and compare.
struct SimulationFlags {
  std::vector<std::string> lidars;  ///< the first, then NAME=LIDAR@X,Y,DEG for each further one
  std::string sensor, strategy, start, form;
  double duration_s = -1;
};
/// --sensor, of them.
void addSensorFlag(CLI::App* command, SimulationFlags& flags);
/// --start, of them.
void addStartFlag(CLI::App* command, SimulationFlags& flags);
void addSimulationFlags(CLI::App* command, SimulationFlags& flags);

/// The layers of a simulation's configuration, weakest first: built-in, the lidar's file, --config, --set,
/// flags.
files::IniFile simulationConfig(const Context& context, const SimulationFlags& flags);

/// Prints what --print-config shows.
void printParameters(const std::vector<files::ParameterReport>& parameters, bool json);

}  // namespace slam::apps
