#include "libslam/run/told_commands.h"

#include <filesystem>

#include "libslam/core/files.h"
#include "libslam/logs/log_reader.h"
#include "libslam/run/record.h"
#include "libslam/sim/operation_log.h"

namespace slam::run {

std::string tellCommands(mapping::MapBuilder& method, const std::string& log_path) {
  if (method.odometry != "argmax") return "";
  const std::string path = logStem(log_path) + ".operations.txt";
  if (!std::filesystem::exists(path)) return "wheels";
  const auto operations = sim::parseOperations(core::readTextFile(path), path);
  mapping::setCommands(method, sim::commandsOfScans(operations, logs::inspectLog(log_path).scans, path));
  return "operation log";
}

std::string commandsNote(const std::string& method_name, const std::string& from) {
  if (from != "wheels") return "";
  return method_name +
         ": no operation log beside the log; whether the robot moved or turned was taken from the wheels";
}

}  // namespace slam::run
