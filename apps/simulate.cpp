#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/console.h"
#include "libslam/core/error.h"
#include "libslam/core/files.h"
#include "libslam/run/record.h"
#include "libslam/run/resources.h"

namespace slam::apps {
namespace {

struct Arguments {
  std::string plan;
  SimulationFlags flags;
};

int simulate(const Context& context, const Arguments& arguments) {
  const auto config = run::readRecordConfig(simulationConfig(context, arguments.flags));
  if (context.print_config) {
    printParameters(config.parameters, context.json);
    return 0;
  }
  const std::string plan_path = run::resolvePlan(arguments.plan);
  const std::string log_path = context.output.empty() ? "run.rawlog" : context.output;
  for (const auto& path : {log_path, run::logStem(log_path) + ".gt.tum"})
    core::refuseToOverwrite(path, context.overwrite);
  const auto plan = world::loadPlan(plan_path);
  auto manifest = context.manifest();
  manifest.inputs[plan_path] = core::fileSha256(plan_path);
  ConsoleProgress progress(context.quiet);
  const auto recording = run::record(plan, config, context.seed, log_path, manifest, progress);
  if (context.json) {
    std::cout << nlohmann::ordered_json{{"files", recording.files},
                                        {"scans", recording.scans},
                                        {"duration_s", recording.duration_s},
                                        {"path_length_m", recording.path_length_m},
                                        {"collisions", recording.collisions.size()}}
                     .dump(2)
              << "\n";
    return 0;
  }
  std::printf("%zu scans in %.1f s over %.1f m, %zu collisions\n", recording.scans, recording.duration_s,
              recording.path_length_m, recording.collisions.size());
  for (const auto& file : recording.files) std::printf("  %s\n", file.c_str());
  std::printf("next: rasterslam compare %s\n", log_path.c_str());
  return 0;
}

}  // namespace

void addSimulate(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand("simulate", "let a robot explore a plan; writes a rawlog and its truth");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("plan", arguments->plan, "bmp, png, pgm, jpg, a ROS map yaml, or a world by name")
      ->required();
  addOutput(command, context, "the rawlog to write (default run.rawlog)");
  addSeed(command, context);
  addSimulationFlags(command, arguments->flags);
  addConfig(command, context);
  addJson(command, context);
  command->footer(
      "Examples:\n"
      "  rasterslam simulate flat -o run.rawlog --seed 7\n"
      "  rasterslam simulate office_loop --set living.people=8   # people walk about: run.movers.csv says "
      "where\n"
      "  rasterslam simulate plan.png --lidar utm30lx --strategy longest_ray --set robot.side_m=0.3");
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return simulate(context, *arguments); };
  });
}

}  // namespace slam::apps
