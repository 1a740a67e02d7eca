#include "apps/user_input.h"

#include <iostream>
#include <iterator>

#include "libslam/files/files.h"
#include "libslam/resources/file_hash.h"
#include "libslam/truth/carry_file.h"

namespace slam::apps {
namespace {

constexpr const char* kStandardInput = "-";

}  // namespace

void addCarry(CLI::App* command, std::vector<std::string>& carries) {
  command
      ->add_option("--carry", carries,
                   "kidnap the robot: TIME_S:X_M,Y_M,HEADING_DEG in the world frame, TIME_S:random, or "
                   "TIME_S:visited for a "
                   "place where it was before; repeat for more")
      ->take_all()
      ->expected(1);
}

files::IniFile withCarries(files::IniFile config, const std::vector<std::string>& carries) {
  std::string all;
  for (const auto& carry : carries) all += (all.empty() ? "" : " ") + carry;
  if (!carries.empty()) config.set("events", "carry", all, "--carry");
  return config;
}

CLI::Option* addCommands(CLI::App* command, std::string& path) {
  return command->add_option(
      "--commands", path,
      "drive by the lines of a file: move METRES, turn DEGREES, # comments; - reads standard input");
}

std::vector<robot::UserCommand> readUserCommands(const std::string& path) {
  if (path.empty()) return {};
  if (path != kStandardInput) return robot::parseUserCommands(files::readTextFile(path), path);
  const std::string text{std::istreambuf_iterator<char>(std::cin), {}};
  return robot::parseUserCommands(text, "standard input");
}

void noteCommands(const std::string& path, resources::Manifest& manifest) {
  if (path.empty()) return;
  manifest.results["driven"] = "by commands";
  if (path != kStandardInput) manifest.inputs[path] = resources::fileSha256(path);
}

std::string eventLines(const record::Recording& recording) {
  std::string lines;
  for (const auto& carry : recording.carries)
    lines += "  " + truth::carryText(carry, sim::Simulator::kStartTime_s) + "\n";
  if (recording.carries_left > 0)
    lines += "  " + std::to_string(recording.carries_left) + " of the carries came after the end\n";
  return lines;
}

}  // namespace slam::apps
