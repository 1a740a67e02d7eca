#include "libslam/sim/operation_log.h"

#include <cmath>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/core/parameters.h"

namespace slam::sim {
namespace {

size_t readingsOf(char kind) {
  return kind == 'm' ? 2 : 1;
}

Operation parseLine(const std::string& line, const std::string& where) {
  const auto fail = [&]() -> core::InputError {
    return core::InputError(where + ": found '" + line +
                            "', expected 'm REAR FRONT' in metres or 't ANGLE' in radians");
  };
  std::istringstream words(line);
  std::string kind, word;
  words >> kind;
  if (kind != "m" && kind != "t") throw fail();
  Operation operation{kind[0], 0, 0};
  size_t readings = 0;
  while (words >> word) {
    double& reading = readings == 0 ? operation.first : operation.second;
    if (++readings > readingsOf(operation.kind) || !core::parseNumber(word, reading)) throw fail();
  }
  if (readings != readingsOf(operation.kind)) throw fail();
  return operation;
}

/// How far a move went, by its two readings.
double stepOf(const Operation& move) {
  const double rear_m = move.first, front_m = move.second;
  if (rear_m == 0) return front_m;
  return front_m == 0 ? -rear_m : (front_m - rear_m) / 2;
}

}  // namespace

std::string formatOperation(const Operation& operation) {
  const bool known = operation.kind == 'm' || operation.kind == 't';
  if (!known || !std::isfinite(operation.first) || !std::isfinite(operation.second))
    throw core::ContractError("formatOperation: expected kind m or t and finite readings");
  std::string line(1, operation.kind);
  line += ' ' + core::formatNumber(operation.first);
  if (operation.kind == 'm') line += ' ' + core::formatNumber(operation.second);
  return line + '\n';
}

std::string formatOperations(const std::vector<Operation>& operations) {
  std::string text;
  for (const auto& operation : operations) text += formatOperation(operation);
  return text;
}

std::vector<Operation> parseOperations(const std::string& text, const std::string& name) {
  std::vector<Operation> operations;
  int number = 0;
  for (size_t begin = 0; begin < text.size();) {
    const std::string where = name + ":" + std::to_string(++number);
    const size_t end = text.find('\n', begin);
    if (end == std::string::npos)
      throw core::InputError(where + ": the last line has no line end, expected a log that is not cut short");
    operations.push_back(parseLine(text.substr(begin, end - begin), where));
    begin = end + 1;
  }
  return operations;
}

core::Trajectory replayOperations(const std::vector<Operation>& operations) {
  core::Trajectory path = {{0, {}}};
  for (const auto& operation : operations) {
    const core::Pose2 T_previous_robot =
        operation.kind == 't' ? core::Pose2{0, 0, operation.first} : core::Pose2{stepOf(operation), 0, 0};
    path.push_back({static_cast<double>(path.size()), path.back().pose * T_previous_robot});
  }
  return path;
}

}  // namespace slam::sim
