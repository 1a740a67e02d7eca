#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/console.h"
#include "apps/plan_warnings.h"
#include "apps/user_input.h"
#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/record/record.h"
#include "libslam/record/user_drive.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/resources.h"
#include "libslam/truth/truth_files.h"

namespace slam::apps {
namespace {

struct SimulateArguments {
  std::string plan, commands;
  SimulationFlags flags;
  std::vector<std::string> carries;
};

nlohmann::ordered_json toJson(const record::UserDrive& drive, std::size_t commands) {
  const auto& recording = drive.recording;
  nlohmann::ordered_json json = {{"files", recording.files},
                                 {"scans", recording.scans},
                                 {"duration_s", recording.duration_s},
                                 {"path_length_m", recording.path_length_m},
                                 {"collisions", recording.collisions.size()},
                                 {"carries", recording.carries.size()},
                                 {"carries_left", recording.carries_left}};
  if (commands == 0) return json;
  json["commands_left"] = commands - drive.outcomes.size();
  for (const auto& outcome : drive.outcomes)
    if (outcome.collided)
      json["stopped"].push_back({{"line", outcome.command.line},
                                 {"command", robot::formatUserCommand(outcome.command)},
                                 {"done_m", outcome.done}});
  return json;
}

void printResult(const record::UserDrive& drive, const std::vector<robot::UserCommand>& commands) {
  const auto& recording = drive.recording;
  std::printf("%zu scans in %.1f s over %.1f m, %zu collisions\n", recording.scans, recording.duration_s,
              recording.path_length_m, recording.collisions.size());
  std::fputs(eventLines(recording).c_str(), stdout);
  for (const auto& outcome : drive.outcomes)
    if (const auto text = record::outcomeText(outcome); !text.empty()) std::printf("  %s\n", text.c_str());
  if (drive.outcomes.size() < commands.size())
    std::printf("  line %d: the time was over, %zu commands are left: see --duration\n",
                commands[drive.outcomes.size()].line, commands.size() - drive.outcomes.size());
  for (const auto& file : recording.files) std::printf("  %s\n", file.c_str());
}

int simulate(const Context& context, const SimulateArguments& arguments) {
  const auto config =
      record::readRecordConfig(withCarries(simulationConfig(context, arguments.flags), arguments.carries));
  if (context.print_config) {
    printParameters(config.parameters, context.json);
    return 0;
  }
  const std::string plan_path = resources::resolvePlan(arguments.plan);
  const auto commands = readUserCommands(arguments.commands);
  const std::string log_path = context.output.empty() ? "run.rawlog" : context.output;
  for (const auto& path : {log_path, truth::besideLog(log_path, ".gt.tum")})
    files::refuseToOverwrite(path, context.overwrite);
  const auto plan = world::loadPlan(plan_path);
  warnOfPlan(context, plan_path);
  auto manifest = context.manifest();
  manifest.inputs[plan_path] = resources::fileSha256(plan_path);
  noteCommands(arguments.commands, manifest);
  ConsoleProgress progress(context.quiet);
  record::UserDrive drive;
  if (commands.empty())
    drive.recording = record::record(plan, config, context.seed, log_path, manifest, progress);
  else
    drive = record::recordUserCommands(plan, config, context.seed, log_path, commands, std::move(manifest),
                                       progress);
  if (context.json) {
    std::cout << toJson(drive, commands.size()).dump(2) << "\n";
    return 0;
  }
  printResult(drive, commands);
  std::printf("next: rasterslam compare %s\n", log_path.c_str());
  return 0;
}

}  // namespace

void addSimulate(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand("simulate", "let a robot explore a plan; writes a rawlog and its truth");
  auto arguments = std::make_shared<SimulateArguments>();
  command->add_option("plan", arguments->plan, "bmp, png, pgm, jpg, a ROS map yaml, or a world by name")
      ->required();
  addOutput(command, context, "the rawlog to write (default run.rawlog)");
  addSeed(command, context);
  addSimulationFlags(command, arguments->flags);
  addCarry(command, arguments->carries);
  addCommands(command, arguments->commands)->excludes("--strategy");
  addConfig(command, context);
  addJson(command, context);
  command->footer(
      "Examples:\n"
      "  rasterslam simulate flat -o run.rawlog --seed 7\n"
      "  rasterslam simulate office_loop --set living.people=8   # people walk about: run.movers.csv says "
      "where\n"
      "  rasterslam simulate plan.png --lidar utm30lx --strategy longest_ray --set robot.side_m=0.3\n"
      "  rasterslam simulate flat --commands drive.txt   # its lines: move 1.5 (metres), turn 25 (degrees)\n"
      "  rasterslam simulate flat --carry 60:11,2,90     # kidnapped after a minute");
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return simulate(context, *arguments); };
  });
}

}  // namespace slam::apps
