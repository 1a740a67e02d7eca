#include "apps/commands.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "apps/quiet.h"
#include "apps/stream_output.h"
#include "libslam/core/error.h"
#include "libslam/files/word_list.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/resources/resources.h"

namespace slam::apps {

resources::Manifest Context::manifest() const {
  resources::Manifest manifest;
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
  command->add_option("--seed", context.seed, "seed of every random stream")
      ->check([](const std::string& word) {
        std::uint64_t seed = 0;
        const auto end = word.data() + word.size();
        const auto read = std::from_chars(word.data(), end, seed);
        const bool is_whole = read.ec == std::errc() && read.ptr == end;
        return is_whole ? "" : "found '" + word + "', expected a whole number from 0 to 2^64 - 1";
      })
      ->capture_default_str();
}

std::string isDuration(const std::string& word) {
  double seconds = 0;
  const bool is_one = files::parseNumber(word, seconds) && seconds >= 0;
  return is_one ? "" : "found '" + word + "', expected a number of seconds from 0 on";
}

void addOutput(CLI::App* command, Context& context, const std::string& what) {
  command
      ->add_option("-o,--output", context.output,
                   streamSuffix(*command).empty() ? what : what + ", or - for standard output")
      ->check([command](const std::string& word) { return streamProblem(*command, word); });
  command->add_flag("--overwrite", context.overwrite, "replace what is there");
  addQuiet(command, context);
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

void addStartFlag(CLI::App* command, SimulationFlags& flags) {
  command->add_option("--start", flags.start, "x_m,y_m,yaw_deg in the world frame, or auto (the default)");
}

void addSimulationFlags(CLI::App* command, SimulationFlags& flags) {
  command->add_option("--strategy", flags.strategy, "where to go: see 'rasterslam list strategies'");
  command
      ->add_option(
          "--lidar", flags.lidars,
          "a lidar by name (see 'rasterslam list lidars') or an .ini file; again for one more on the "
          "robot, as rear=LIDAR@X,Y,DEG (metres and degrees from the robot's centre)")
      ->take_all()
      ->expected(1);
  addSensorFlag(command, flags);
  command->add_option("--duration", flags.duration_s, "longest recording, seconds of the robot's time")
      ->check(isDuration);
  addStartFlag(command, flags);
  command->add_option("--form", flags.form, "form of the rawlog: action or observation");
}

namespace {

/// The file of a lidar by name or path.
files::IniFile loadLidar(const std::string& lidar) {
  const bool is_path = lidar.find_first_of("/.") != std::string::npos;
  const std::string folder = resources::configsFolder() + "/lidars";
  if (!is_path) {
    const auto names = resources::namesInFolder(folder, ".ini");
    if (std::find(names.begin(), names.end(), lidar) == names.end())
      throw core::InputError("--lidar: found '" + lidar + "', expected a name of 'rasterslam list lidars'" +
                             core::didYouMean(lidar, names));
  }
  return resources::readConfigFile(is_path ? lidar : folder + "/" + lidar + ".ini");
}

/// Section [lidar] of "LIDAR", or [lidar NAME] of "NAME=LIDAR@X,Y,DEG".
void addLidar(const std::string& argument, files::IniFile& config) {
  const auto equals = argument.find('=');
  if (equals == std::string::npos) return config.overrideWith(loadLidar(argument));
  const auto at = argument.find('@', equals);
  const auto fail = [&] {
    throw core::InputError("--lidar: found '" + argument +
                           "', expected NAME=LIDAR@X,Y,DEG, as rear=tim571@-0.1,0,180");
  };
  if (equals == 0 || at == std::string::npos) fail();
  const std::string section = "lidar " + argument.substr(0, equals);
  const auto preset = loadLidar(argument.substr(equals + 1, at - equals - 1));
  if (const auto it = preset.sections().find("lidar"); it != preset.sections().end())
    for (const auto& [key, entry] : it->second) config.set(section, key, entry.value, entry.origin);
  const std::vector<std::string> keys = {"mount_x_m", "mount_y_m", "mount_yaw_deg"};
  const auto numbers = files::splitAt(argument.substr(at + 1), ',');
  if (numbers.size() != keys.size()) fail();
  for (std::size_t i = 0; i < keys.size(); ++i) {
    double value = 0;
    if (!files::parseNumber(numbers[i], value)) fail();
    config.set(section, keys[i], numbers[i], "--lidar");
  }
}

}  // namespace

files::IniFile simulationConfig(const Context& context, const SimulationFlags& flags) {
  files::IniFile config;
  for (const auto& lidar : flags.lidars) addLidar(lidar, config);
  if (!context.config.empty()) config.overrideWith(resources::readConfigFile(context.config));
  for (const auto& setting : context.settings) config.setFromArgument(setting, "--set");
  if (!flags.sensor.empty()) config.set("sensor", "kind", flags.sensor, "--sensor");
  if (!flags.strategy.empty()) config.set("strategy", "name", flags.strategy, "--strategy");
  if (!flags.start.empty()) config.set("simulation", "start", flags.start, "--start");
  if (!flags.form.empty()) config.set("simulation", "log_form", flags.form, "--form");
  if (flags.duration_s >= 0)
    config.set("simulation", "duration_s", files::formatNumber(flags.duration_s), "--duration");
  return config;
}

void printParameters(const std::vector<files::ParameterReport>& parameters, bool json) {
  if (!json) {
    std::cout << files::formatParameterReport(parameters);
    return;
  }
  auto list = nlohmann::ordered_json::array();
  for (const auto& p : parameters) {
    list.push_back({{"section", p.section},
                    {"key", p.info.key},
                    {"value", p.value},
                    {"origin", p.origin},
                    {"meaning", p.info.doc}});
    if (std::holds_alternative<bool>(p.info.default_value)) list.back()["choices"] = {"true", "false"};
    if (!p.info.choices.empty()) list.back()["choices"] = p.info.choices;
  }
  std::cout << list.dump(2) << "\n";
}

}  // namespace slam::apps
