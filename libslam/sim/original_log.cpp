#include "libslam/sim/original_log.h"

#include <cmath>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/files/parameters.h"

namespace slam::sim {
namespace {

void requirePixel(const OriginalUnits& units) {
  if (!(units.pixel_m > 0) || !std::isfinite(units.pixel_m))
    throw core::ContractError("original log: expected a positive size of a pixel");
}

/// A line without the carriage return that some systems end lines with.
std::string trimmed(std::string line) {
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
  return line;
}

/// Lines of the log, one after another.
class Lines {
 public:
  Lines(const std::string& text, const std::string& name) : text_(text), name_(name) {}

  bool next(std::string& line) {
    if (!std::getline(text_, line)) return false;
    ++number_;
    line = trimmed(line);
    return true;
  }
  /// `what` is the number's name and unit.
  double wholeNumber(const std::string& what) {
    std::string line;
    if (!next(line))
      throw core::InputError(name_ + ":" + std::to_string(number_) + ": the log ends here, expected " + what);
    double value = 0;
    if (!files::parseNumber(line, value) || value != std::floor(value) || std::abs(value) > 1e9)
      throw fail(line, what);
    return value;
  }
  core::InputError fail(const std::string& line, const std::string& expected) const {
    return core::InputError(name_ + ":" + std::to_string(number_) + ": found '" + line + "', expected " +
                            expected);
  }

 private:
  std::istringstream text_;
  std::string name_;
  int number_ = 0;
};

std::string turnLines(long degrees) {
  return "t\n" + std::to_string(degrees) + "\n";
}

}  // namespace

std::string formatOriginalLog(const std::vector<Operation>& operations, const OriginalUnits& units) {
  requirePixel(units);
  const auto pixels = [&](double metres) { return std::to_string(std::lround(metres / units.pixel_m)); };
  const auto degrees = [&](double angle_rad) {
    return std::lround(core::radToDeg(units.clockwise ? -angle_rad : angle_rad));
  };
  std::string text;
  for (const auto& operation : operations) {
    if (operation.kind == 't') {
      text += turnLines(degrees(operation.first));
      continue;
    }
    const std::string move = "m\n" + pixels(operation.first) + "\n" + pixels(operation.second) + "\n";
    const long half = degrees(operation.third / 2);
    text +=
        operation.kind == 'm' ? move : turnLines(half) + move + turnLines(degrees(operation.third) - half);
  }
  return text;
}

std::vector<Operation> parseOriginalLog(const std::string& text, const OriginalUnits& units,
                                        const std::string& name) {
  requirePixel(units);
  std::vector<Operation> operations;
  Lines lines(text, name);
  for (std::string line; lines.next(line);) {
    if (line == "m") {
      const double rear_m = lines.wholeNumber("the rear reading of a move in whole pixels") * units.pixel_m;
      const double front_m = lines.wholeNumber("the front reading of a move in whole pixels") * units.pixel_m;
      operations.push_back({'m', rear_m, front_m});
    } else if (line == "t") {
      const double angle_rad = core::degToRad(lines.wholeNumber("the angle of a turn in whole degrees"));
      operations.push_back({'t', units.clockwise ? -angle_rad : angle_rad});
    } else {
      throw lines.fail(line, "'m' or 't' on a line of its own");
    }
  }
  return operations;
}

bool isOriginalLog(const std::string& text) {
  const std::string line = trimmed(text.substr(0, text.find('\n')));
  return line == "m" || line == "t";
}

}  // namespace slam::sim
