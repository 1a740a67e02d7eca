#include "apps/commands.h"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "libslam/core/error.h"
#include "libslam/run/resources.h"

namespace slam::apps {

core::Manifest Context::manifest() const {
  core::Manifest manifest;
  manifest.command_line = command_line;
  manifest.seed = seed;
  return manifest;
}

std::string Context::programPath() const {
  std::error_code error;
  const auto path = std::filesystem::read_symlink("/proc/self/exe", error);
  return error ? command_line.front() : path.string();
}

const std::vector<std::string>& defaultMethods() {
  static const std::vector<std::string> kMethods = {"naive", "naive_correlation", "naive_flow", "icp",
                                                    "rbpf",  "rbpf_exact",        "particles",  "graph"};
  return kMethods;
}

void addSeed(CLI::App* command, Context& context) {
  command->add_option("--seed", context.seed, "seed of every random stream")->capture_default_str();
}

void addOutput(CLI::App* command, Context& context, const std::string& what) {
  command->add_option("-o,--output", context.output, what);
  command->add_flag("--overwrite", context.overwrite, "replace what is there");
  command->add_flag("-q,--quiet", context.quiet, "no progress on standard error");
}

void addConfig(CLI::App* command, Context& context) {
  command->add_option("--config", context.config, "an .ini file over the built-in values");
  command->add_option("--set", context.settings, "section.key=value, over the file; repeat for more")
      ->take_all()
      ->expected(1);
  command->add_flag("--print-config", context.print_config,
                    "print every value and where it came from, and stop");
}

void addJson(CLI::App* command, Context& context) {
  command->add_flag("--json", context.json, "print JSON instead of text");
}

void addSensorFlag(CLI::App* command, SimulationFlags& flags) {
  command->add_option(
      "--sensor", flags.sensor,
      "what the robot looks with: lidar, or a camera that sees the floor (--set camera.KEY=...)");
}

void addSimulationFlags(CLI::App* command, SimulationFlags& flags) {
  command->add_option("--strategy", flags.strategy, "where to go: see 'rasterslam list strategies'");
  command->add_option("--lidar", flags.lidar,
                      "a lidar by name (see 'rasterslam list lidars') or an .ini file");
  addSensorFlag(command, flags);
  command->add_option("--duration", flags.duration_s, "longest recording, seconds of the robot's time");
  command->add_option("--form", flags.form, "form of the rawlog: action or observation");
}

core::IniFile simulationConfig(const Context& context, const SimulationFlags& flags) {
  core::IniFile config;
  if (!flags.lidar.empty()) {
    const bool is_path = flags.lidar.find_first_of("/.") != std::string::npos;
    const std::string folder = run::configsFolder() + "/lidars";
    if (!is_path) {
      const auto names = run::namesInFolder(folder, ".ini");
      if (std::find(names.begin(), names.end(), flags.lidar) == names.end())
        throw core::InputError("--lidar: found '" + flags.lidar +
                               "', expected a name of 'rasterslam list lidars'" +
                               core::didYouMean(flags.lidar, names));
    }
    config = core::IniFile::load(is_path ? flags.lidar : folder + "/" + flags.lidar + ".ini");
  }
  if (!context.config.empty()) config.overrideWith(core::IniFile::load(context.config));
  for (const auto& setting : context.settings) config.setFromArgument(setting, "--set");
  if (!flags.sensor.empty()) config.set("sensor", "kind", flags.sensor, "--sensor");
  if (!flags.strategy.empty()) config.set("strategy", "name", flags.strategy, "--strategy");
  if (!flags.form.empty()) config.set("simulation", "log_form", flags.form, "--form");
  if (flags.duration_s >= 0)
    config.set("simulation", "duration_s", core::formatNumber(flags.duration_s), "--duration");
  return config;
}

void printParameters(const std::vector<core::ParameterReport>& parameters, bool json) {
  if (!json) {
    std::cout << core::formatParameterReport(parameters);
    return;
  }
  auto list = nlohmann::ordered_json::array();
  for (const auto& p : parameters)
    list.push_back({{"section", p.section},
                    {"key", p.info.key},
                    {"value", p.value},
                    {"origin", p.origin},
                    {"meaning", p.info.doc}});
  std::cout << list.dump(2) << "\n";
}

}  // namespace slam::apps
