#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libslam/mapping/map_builder.h"

namespace slam::run {

/// What the robot was commanded to do before each scan of a log, as the operation log beside it
/// (STEM.operations.txt) has it; nothing where there is none. Reads the log once to count its scans. Errors:
/// InputError for an operation log that cannot be read or is not of this log.
std::optional<std::vector<robot::Commanded>> commandsOfLog(const std::string& log_path);

/// Tells a method that reads moves and turns differently ([method] odometry = argmax) what the robot was
/// commanded to do before each scan of a log: by commandsOfLog(). Returns where the method has the kinds
/// from: "operation log"; "wheels" where it will go by the increments of the wheels' odometry; "" for the
/// other methods. Errors: those of commandsOfLog().
std::string tellCommands(mapping::MapBuilder& method, const std::string& log_path);

/// A line for people where the kinds are the wheels', "" elsewhere. `from` is what tellCommands() gave.
std::string commandsNote(const std::string& method_name, const std::string& from);

}  // namespace slam::run
