#pragma once
#include <string>

#include "libslam/mapping/map_builder.h"

namespace slam::run {

/// Tells a method that reads moves and turns differently ([method] odometry = argmax) what the robot was commanded to do
/// before each scan of a log: from the operation log beside it (STEM.operations.txt), where there is one. Returns where the
/// method has the kinds from: "operation log"; "wheels" where it will go by the increments of the wheels' odometry; "" for
/// the other methods. Reads the log once to count its scans. Errors: InputError for an operation log that cannot be read or is not of
/// this log.
std::string tellCommands(mapping::MapBuilder& method, const std::string& log_path);

/// A line for people where the kinds are the wheels', "" elsewhere. `from` is what tellCommands() gave.
std::string commandsNote(const std::string& method_name, const std::string& from);

}  // namespace slam::run
