#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/console.h"
#include "apps/quiet.h"
#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/resources/resources.h"
#include "libslam/run/external_method.h"

namespace slam::apps {
namespace {

struct PluginArguments {
  std::string method, log;
};

void printCheck(const run::ExternalRun& run, const std::string& name, std::size_t scans) {
  for (const auto& violation : run.violations) std::printf("violation: %s\n", violation.c_str());
  std::printf("%.3f ms of CPU time per scan, %.1f MB\n", run.cost.mean_ms_per_scan, run.cost.peak_memory_mb);
  if (!run.violations.empty()) {
    std::printf("%s breaks the contract (rasterslam plugin --help)\n", name.c_str());
    return;
  }
  std::printf("%s keeps the contract: %zu of %zu scans have a pose", name.c_str(),
              scans - static_cast<std::size_t>(run.filled_poses), scans);
  std::printf(run.filled_poses > 0 ? ", the others get one from the odometry between them\n" : "\n");
}

int checkPlugin(const Context& context, const PluginArguments& arguments) {
  auto config = mapping::loadMethodConfig(resources::configsFolder() + "/plugins", arguments.method);
  for (const auto& setting : context.settings) config.setFromArgument(setting, "--set");
  const std::string name = std::filesystem::path(arguments.method).stem().string();
  if (!run::isExternal(config))
    throw core::InputError(arguments.method +
                           ": section [method], key 'type': expected external; see "
                           "'rasterslam plugin --help'");
  const auto method = run::readExternalMethod(config);
  if (context.print_config) {
    printParameters(method.parameters, context.json);
    return 0;
  }
  ConsoleProgress progress(context.quiet);
  const files::ScratchFolder scratch;
  const auto run = run::runExternalMethod(method, arguments.log, context.seed, scratch / "work", progress);
  if (context.json)
    std::cout << nlohmann::ordered_json{{"method", name},
                                        {"violations", run.violations},
                                        {"scans", run.path.size()},
                                        {"filled_poses", run.filled_poses},
                                        {"mean_ms_per_scan", run.cost.mean_ms_per_scan},
                                        {"peak_memory_mb", run.cost.peak_memory_mb}}
                     .dump(2)
              << "\n";
  else
    printCheck(run, name, run.path.size());
  return static_cast<int>(run.violations.empty() ? core::ExitCode::kOk : core::ExitCode::kMethodFailed);
}

}  // namespace

void addPlugin(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand("plugin", "any program as a method: what it owes, and a check of it");
  command->require_subcommand(1);
  command->footer(
      "A method is an .ini that 'run' and 'compare' take like any other:\n"
      "  [method]\n"
      "  type = external\n"
      "  command = sh {here}/my_slam.sh {log} {output}\n"
      "  log = action              # MRPT rawlog: action or observation; or carmen\n"
      "  time_limit_s = 3600       # of the clock, then it is killed; memory_limit_mb likewise\n"
      "  [mapping]\n"
      "  resolution_m = 0.05       # of the map that we draw from its poses and the scans\n\n"
      "The command is a line for /bin/sh, run in an empty folder without input, in which\n"
      "  {log}      is the log to read, without any truth\n"
      "  {output}   the trajectory to write, TUM: time x y z qx qy qz qw per line\n"
      "  {scans}    a text with a line per scan: its stamp, and x y yaw (m, rad) of the wheels\n"
      "  {workdir}  the folder it runs in, removed afterwards\n"
      "  {seed}     the seed of the run\n"
      "  {here}     the folder of the .ini\n"
      "(a ';' or '#' behind a blank begins a comment in an .ini: longer work belongs into a script).\n\n"
      "It owes: exit code 0; {output} with a line per pose, finite, the quaternion of length 1, the\n"
      "stamp that of a scan of the log to 0.1 ms, no scan twice, in the order of the stamps or of the\n"
      "log. Scans that it leaves out get a pose from its neighbours and the odometry between them.\n"
      "What the command names by an absolute path, or finds by the PATH, is a part of the method: after\n"
      "a change there --resume does its runs again.\n"
      "Time is CPU time of all its processes, with reading the log; memory the largest of them, whole.\n\n"
      "Examples in configs/plugins: icp-slam, rbpf-slam and graphslam-engine of MRPT.\n"
      "  rasterslam plugin check configs/plugins/graphslam-engine.ini run.rawlog\n"
      "  rasterslam compare run.rawlog --methods graph,configs/plugins/graphslam-engine.ini -o cmp");
  auto* check = command->add_subcommand("check", "run it on a log; a line for everything it owes");
  auto arguments = std::make_shared<PluginArguments>();
  check->add_option("method", arguments->method, "the .ini, or the name of one in configs/plugins")
      ->required();
  check->add_option("log", arguments->log, "a log: MRPT rawlog, CARMEN, ...")->required();
  check->add_option("--set", context.settings, "section.key=value, over the file; repeat for more")
      ->take_all()
      ->expected(1);
  check->add_flag("--print-config", context.print_config,
                  "print every value and where it came from, and stop");
  addQuiet(check, context);
  addSeed(check, context);
  addJson(check, context);
  check->footer(
      "Exit code 0: it keeps the contract; 4: it does not.\n"
      "Example:\n  rasterslam plugin check my_slam.ini run.rawlog");
  check->callback([&context, arguments] {
    context.action = [&context, arguments] { return checkPlugin(context, *arguments); };
  });
}

}  // namespace slam::apps
