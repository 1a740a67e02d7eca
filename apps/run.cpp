#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/console.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/run/build_map.h"
#include "libslam/run/external_method.h"
#include "libslam/run/resources.h"

namespace slam::apps {
namespace {

struct Arguments {
  std::string method, log;
};

int runMethod(const Context& context, const Arguments& arguments) {
  auto config = mapping::loadMethodConfig(run::configsFolder() + "/methods", arguments.method);
  if (!context.config.empty()) config.overrideWith(core::IniFile::load(context.config));
  for (const auto& setting : context.settings) config.setFromArgument(setting, "--set");
  const std::string name = std::filesystem::path(arguments.method).stem().string();
  if (context.print_config) {
    printParameters(run::methodParameters(config, name, context.seed), context.json);
    return 0;
  }
  const std::string folder = context.output.empty() ? name : context.output;
  ConsoleProgress progress(context.quiet);
  const auto result = run::buildMap(arguments.log, config, name, context.seed, folder, context.overwrite,
                                    context.manifest(), progress);
  if (result.steps_without_odometry > 0)
    std::fprintf(stderr,
                 "rasterslam: %s: %d of %zu steps come without odometry, estimated from the scans instead\n",
                 arguments.log.c_str(), result.steps_without_odometry, result.estimate.size() - 1);
  const auto& end = result.end;
  if (context.json) {
    std::cout << nlohmann::ordered_json{{"folder", folder},
                                        {"method", name},
                                        {"scans", result.estimate.size()},
                                        {"path_length_m", result.path_length_m},
                                        {"end_pose", {end.x, end.y, end.phi}},
                                        {"mean_ms_per_scan", result.cost.mean_ms_per_scan},
                                        {"p99_ms_per_scan", result.cost.p99_ms_per_scan},
                                        {"peak_memory_mb", result.cost.peak_memory_mb}}
                     .dump(2)
              << "\n";
    return 0;
  }
  std::printf("%s: %zu scans, path %.2f m, end at x %.2f m, y %.2f m, yaw %.1f deg\n", name.c_str(),
              result.estimate.size(), result.path_length_m, end.x, end.y, core::radToDeg(end.phi));
  std::printf("%.3f ms per scan (p99 %.3f), %.0f x real time, %.1f MB\n", result.cost.mean_ms_per_scan,
              result.cost.p99_ms_per_scan, result.cost.real_time_factor, result.cost.peak_memory_mb);
  const auto manifest = core::readManifest(folder + "/manifest.json");
  for (const auto& [file, meaning] : manifest.files)
    std::printf("  %-32s %s\n", (folder + "/" + file).c_str(), meaning.c_str());
  return 0;
}

}  // namespace

void addRun(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand("run", "run one SLAM method over a log; writes its map and path");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("method", arguments->method, "a name of 'rasterslam list methods', or an .ini file")
      ->required();
  command->add_option("log", arguments->log, "a log: MRPT rawlog, CARMEN, ...")->required();
  addOutput(command, context, "folder to write (default: the method's name)");
  addSeed(command, context);
  addConfig(command, context);
  addJson(command, context);
  command->footer(
      "Examples:\n"
      "  rasterslam run icp run.rawlog -o out\n"
      "  rasterslam run rbpf_exact run.rawlog -o out --set mapping.resolution_m=0.05 --seed 3\n"
      "  rasterslam run icp run.rawlog --print-config");
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return runMethod(context, *arguments); };
  });
}

}  // namespace slam::apps
