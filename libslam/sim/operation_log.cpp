#include "libslam/sim/operation_log.h"

#include <cmath>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/files/parameters.h"

namespace slam::sim {
namespace {

constexpr const char* kExpected =
    "expected 'm REAR FRONT' in metres, 't ANGLE' in radians or 'a REAR FRONT ANGLE', and the numbers of the "
    "scans "
    "before and after it";

/// 0: no such kind.
size_t readingsOf(char kind) {
  switch (kind) {
    case 't':
      return 1;
    case 'm':
      return 2;
    case 'a':
      return 3;
    default:
      return 0;
  }
}

bool isScanNumber(double value) {
  return value >= 0 && value < 1e15 && value == std::floor(value);
}

bool hasScans(const Operation& operation) {
  return operation.scan_after > 0;
}

/// The numbers after the letter; false when a word is none.
bool readNumbers(std::istringstream& words, std::vector<double>& numbers) {
  std::string word;
  for (double number = 0; words >> word; numbers.push_back(number))
    if (!files::parseNumber(word, number)) return false;
  return true;
}

Operation parseLine(const std::string& line, const std::string& where) {
  const auto fail = [&]() { return core::InputError(where + ": found '" + line + "', " + kExpected); };
  std::istringstream words(line);
  std::string kind;
  words >> kind;
  const size_t readings = kind.size() == 1 ? readingsOf(kind[0]) : 0;
  std::vector<double> numbers;
  if (readings == 0 || !readNumbers(words, numbers)) throw fail();
  const bool numbered = numbers.size() == readings + 2;
  if (numbers.size() != readings && !numbered) throw fail();
  Operation operation{kind[0], numbers[0], readings > 1 ? numbers[1] : 0, readings > 2 ? numbers[2] : 0};
  if (!numbered) return operation;
  const double before = numbers[readings], after = numbers[readings + 1];
  if (!isScanNumber(before) || !isScanNumber(after) || after <= before) throw fail();
  operation.scan_before = static_cast<std::uint64_t>(before);
  operation.scan_after = static_cast<std::uint64_t>(after);
  return operation;
}

void requireOrder(const Operation& last, const Operation& next, const std::string& where) {
  if (hasScans(last) != hasScans(next))
    throw core::InputError(where + ": found a line " + (hasScans(next) ? "with" : "without") +
                           " scan numbers, expected all lines to have them or none");
  if (hasScans(next) && next.scan_before < last.scan_after)
    throw core::InputError(where + ": found an operation from scan " + std::to_string(next.scan_before) +
                           ", expected at least " + std::to_string(last.scan_after) +
                           ", where the one before ended");
}

/// How far a move went, by its two readings.
double stepOf(const Operation& move) {
  const double rear_m = move.first, front_m = move.second;
  if (rear_m == 0) return front_m;
  return front_m == 0 ? -rear_m : (front_m - rear_m) / 2;
}

core::Pose2 motionOf(const Operation& operation) {
  if (operation.kind == 't') return {0, 0, operation.first};
  const core::Pose2 step{stepOf(operation), 0, 0};
  if (operation.kind == 'm') return step;
  const core::Pose2 half_turn{0, 0, operation.third / 2};
  return half_turn * step * half_turn;
}

}  // namespace

std::string formatOperation(const Operation& operation) {
  const size_t readings = readingsOf(operation.kind);
  const double values[] = {operation.first, operation.second, operation.third};
  bool good = readings > 0 && (operation.scan_before < operation.scan_after ||
                               (operation.scan_before == 0 && operation.scan_after == 0));
  std::string line(1, operation.kind);
  for (size_t i = 0; i < readings; ++i) {
    good = good && std::isfinite(values[i]);
    line += ' ' + files::formatNumber(values[i]);
  }
  if (!good)
    throw core::ContractError(
        "formatOperation: expected kind m, t or a, finite readings and scans in their order");
  if (hasScans(operation))
    line += ' ' + std::to_string(operation.scan_before) + ' ' + std::to_string(operation.scan_after);
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
    const Operation operation = parseLine(text.substr(begin, end - begin), where);
    if (!operations.empty()) requireOrder(operations.back(), operation, where);
    operations.push_back(operation);
    begin = end + 1;
  }
  return operations;
}

core::Trajectory replayOperations(const std::vector<Operation>& operations) {
  core::Trajectory path = {{0, {}}};
  for (const auto& operation : operations)
    path.push_back({static_cast<double>(path.size()), path.back().pose * motionOf(operation)});
  return path;
}

std::vector<robot::Commanded> commandsOfScans(const std::vector<Operation>& operations, std::uint64_t scans,
                                              const std::string& name) {
  using Kind = robot::MotionKind;
  std::vector<robot::Commanded> commands(scans, Kind::kRest);
  const bool numbered = !operations.empty() && hasScans(operations.front());
  if (!numbered && !operations.empty() && operations.size() + 1 != scans)
    throw core::InputError(name + ": found " + std::to_string(operations.size()) +
                           " operations without scan numbers beside a log of " + std::to_string(scans) +
                           " scans, expected one between two scans");
  for (size_t i = 0; i < operations.size(); ++i) {
    const Operation& operation = operations[i];
    const std::uint64_t before = numbered ? operation.scan_before : i;
    const std::uint64_t after = numbered ? operation.scan_after : i + 1;
    if (after >= scans)
      throw core::InputError(name + ":" + std::to_string(i + 1) + ": found scan number " +
                             std::to_string(after) + ", expected less than " + std::to_string(scans) +
                             ", the scans of the log beside it");
    const Kind kind =
        operation.kind == 'm' ? Kind::kMove : (operation.kind == 't' ? Kind::kTurn : Kind::kArc);
    for (std::uint64_t scan = before + 1; scan <= after; ++scan) commands[scan] = {kind, scan > before + 1};
  }
  return commands;
}

}  // namespace slam::sim
