#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "libslam/files/ini.h"
#include "libslam/record/record.h"
#include "libslam/resources/manifest.h"
#include "libslam/robot/user_command.h"

namespace slam::apps {

/// --carry, of what has a robot that can be kidnapped.
void addCarry(CLI::App* command, std::vector<std::string>& carries);

/// The configuration with them on top.
files::IniFile withCarries(files::IniFile config, const std::vector<std::string>& carries);

/// --commands FILE: a person's commands to the robot.
CLI::Option* addCommands(CLI::App* command, std::string& path);

/// Those of the file; "-": of the standard input, to its end; "": none. Errors: InputError with file and
/// line.
std::vector<robot::UserCommand> readUserCommands(const std::string& path);

/// Notes in a manifest which file they are from.
void noteCommands(const std::string& path, resources::Manifest& manifest);

/// A line for every time that the robot was kidnapped, and one for the orders that the end came before.
std::string eventLines(const record::Recording& recording);

}  // namespace slam::apps
