#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "libslam/files/ini.h"
#include "libslam/files/parameters.h"
#include "libslam/record/record.h"

namespace slam::sweep {

/// Section [suite]: the axes of a sweep, lists separated by commas. What is crossed with what: worlds x
/// robots x lidars x odometry x strategies x faults x seeds makes the logs that are simulated, and with
/// `logs` x seeds x methods x [parameters METHOD] the runs.
struct SuiteOptions {
  std::string worlds, logs, robots, lidars, odometry, strategies, faults, methods, seeds, baseline, metric,
      keep;
  double failure_ate_m;
  SuiteOptions();
  static const files::ParameterTable<SuiteOptions>& table();
};

/// Section [limits]: what one cell of a sweep may take.
struct CellLimits {
  int time_limit_s;
  double wall_limit_s;
  double memory_limit_mb;
  CellLimits();
  static const files::ParameterTable<CellLimits>& table();
};

/// One value of an axis of the simulation: its name in tables, and the configuration that it lays over.
struct SuiteVariant {
  std::string name;
  files::IniFile overlay;
};

/// A building to simulate in: a plan's file, or one that generateWorld() draws.
struct SuiteWorld {
  std::string name;
  std::string plan_path;  ///< "" for a generated one
  std::string kind;
  files::IniFile building;  ///< section [building]
  std::uint64_t seed = 1;   ///< of the building, not of the run
  std::string sha256;       ///< planSha256()
};

/// A log that exists already, with what is known of it ("" where nothing is).
struct SuiteLog {
  std::string name, path, truth_path, plan_path, relations_path;
  std::string sha256;  ///< of the bytes of all of them
};

/// A method with one choice of the swept parameters.
struct SuiteMethod {
  std::string name;
  std::string parameters;  ///< "graph.keyframe_m=0.5 mapping.grid=exact", or ""
  files::IniFile config;
  std::map<std::string, std::string> programs;  ///< programFiles() of an external one
};
/// "graph", or "graph graph.keyframe_m=0.5".
std::string fullName(const SuiteMethod& method);

/// A sweep as its .ini says it, every name resolved and every value checked.
struct Suite {
  std::string path;    ///< the file
  std::string folder;  ///< that the relative paths in it start from
  std::string text;    ///< its bytes, of YAML as .ini
  SuiteOptions options;
  CellLimits limits;
  files::IniFile base;  ///< the suite's own sections [robot] ... [simulation], under every overlay
  std::vector<SuiteWorld> worlds;
  std::vector<SuiteLog> logs;
  std::vector<SuiteVariant> robots, lidars, odometry, strategies, faults;
  std::vector<SuiteMethod> methods;
  std::vector<std::uint64_t> seeds;
};

/// Reads a suite. Besides [suite] and [limits] its sections are
///   [robot] [lidar] [odometry] [strategy] [living] [simulation]   as in --config, for all simulated logs
///   [robot NAME] [lidar NAME] [odometry NAME] [strategy NAME] [fault NAME]   a value of that axis: keys
///                                                                            `section.key`
///       laid over, and `base` (an .ini, or a lidar by name) to start from
///   [world NAME]       kind, seed and the keys of [building]; or plan
///   [log NAME]         path, and truth, plan, relations where they are known (default: as findTruth() and
///                      findPlan() say)
///   [method NAME]      base, a method by name or .ini, and keys `section.key` over it
///   [parameters NAME]  keys `section.key`, each with a list of values: the grid for the method of that name
///   [tune] [tune.parameters]   what tune() reads; no part of the sweep
/// An entry of a list is the name of such a section, or else: for worlds a world by name, a plan's file or
/// KIND:seed=3:width_m=40; for logs a file; for lidars a name of configs/lidars; for strategies a strategy's
/// name; for methods a name of configs/methods; for all of them but worlds and logs an .ini file; `built-in`
/// for no overlay. Layers, weakest first: built-in, the suite's own sections, robot, lidar, odometry,
/// strategy, fault.
///
/// A method may be an external program (external_method.h): its line is part of what decides a cell, what it
/// starts is not, so after a change of that program a sweep takes --overwrite.
///
/// Relative paths start from the suite's folder. Errors, all before anything runs (InputError, with the line
/// where there is one): unknown section, key, name or value; a section that no list names; a name twice; a
/// seed twice; files that are missing or broken; a combination whose values do not fit.
/// `folder` takes the place of the suite's folder unless "".
/// A file in YAML (resources::parseYaml()) means the .ini that it stands for.
Suite readSuite(const std::string& path, const std::string& folder = "");
/// Whether a file is a suite by its name, one in YAML by its section `suite`: plans have that ending too.
bool isSuiteFile(const std::string& path);
/// The same of a suite that is not in a file as it stands: `path` stands for it in errors and gives it its
/// name.
Suite readSuite(const files::IniFile& ini, const std::string& path, const std::string& folder);

/// The configuration of a simulated log: all layers.
files::IniFile layered(const Suite& suite, const SuiteVariant& robot, const SuiteVariant& lidar,
                       const SuiteVariant& odometry, const SuiteVariant& strategy, const SuiteVariant& fault);

/// The plan of a world, named after it.
world::Plan loadWorld(const SuiteWorld& world);

/// SHA-256 of what a plan says, whatever file it came from: size, placement, cells, materials, doors.
std::string planSha256(const world::Plan& plan);

}  // namespace slam::sweep
