#include "libslam/run/told_commands.h"

#include <filesystem>
#include <utility>

#include "libslam/files/files.h"
#include "libslam/logs/log_reader.h"
#include "libslam/record/record.h"
#include "libslam/sim/operation_log.h"
#include "libslam/truth/truth_files.h"

namespace slam::run {

std::optional<std::vector<robot::Commanded>> commandsOfLog(const std::string& log_path) {
  const std::string path = truth::besideLog(log_path, ".operations.txt");
  if (!std::filesystem::exists(path)) return std::nullopt;
  const auto operations = sim::parseOperations(files::readTextFile(path), path);
  return sim::commandsOfScans(operations, logs::inspectLog(log_path).scans, path);
}

std::string tellCommands(mapping::MapBuilder& method, const std::string& log_path) {
  if (method.odometry != "argmax") return "";
  auto commands = commandsOfLog(log_path);
  if (!commands) return "wheels";
  mapping::setCommands(method, std::move(*commands));
  return "operation log";
}

std::string commandsNote(const std::string& method_name, const std::string& from) {
  if (from != "wheels") return "";
  return method_name +
         ": no operation log beside the log; whether the robot moved or turned was taken from the wheels";
}

}  // namespace slam::run
