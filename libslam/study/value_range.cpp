#include "libslam/study/value_range.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/files/ini.h"
#include "libslam/files/parameters.h"
#include "libslam/files/word_list.h"

namespace slam::study {
namespace {

constexpr int kMostSteps = 1000;

double rounded(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return std::strtod(text, nullptr);
}

bool isWholeText(const std::string& text) {
  return text.find_first_not_of("-0123456789") == std::string::npos;
}

/// Share of the way from low to high.
double valueAt(const ValueRange& range, double share) {
  if (range.is_log) return range.low * core::pow(range.high / range.low, share);
  return range.low + (range.high - range.low) * share;
}

}  // namespace

ValueRange readValueRange(const std::string& text, const std::string& place) {
  const auto refuse = [&](const std::string& expected) -> core::InputError {
    return core::InputError(place + ": found '" + text + "', expected " + expected);
  };
  ValueRange range;
  const auto dots = text.find("..");
  if (dots == std::string::npos) {
    range.list = files::splitAt(text, ',');
    if (range.list.empty() || std::count(range.list.begin(), range.list.end(), "") > 0)
      throw refuse("low..high, low..high:steps, low..high:log or a list a, b, c");
    return range;
  }
  const auto parts = files::splitAt(text.substr(dots + 2), ':');
  const std::string low = files::trimmed(text.substr(0, dots));
  if (parts.empty() || !files::parseNumber(low, range.low) || !files::parseNumber(parts[0], range.high))
    throw refuse("two numbers low..high");
  if (!(range.high > range.low)) throw refuse("low..high with high above low");
  range.is_whole = isWholeText(low) && isWholeText(parts[0]);
  for (std::size_t i = 1; i < parts.size(); ++i) {
    double steps = 0;
    if (parts[i] == "log" && !range.is_log)
      range.is_log = true;
    else if (range.steps == 0 && files::parseNumber(parts[i], steps) && isWholeText(parts[i]) && steps >= 2 &&
             steps <= kMostSteps)
      range.steps = static_cast<int>(steps);
    else
      throw refuse("after low..high only :steps (2 to " + std::to_string(kMostSteps) + ") and :log");
  }
  if (range.is_log && !(range.low > 0)) throw refuse("ends above 0 with :log");
  return range;
}

std::vector<double> spacedValues(const ValueRange& range, int steps_if_not_said, bool whole,
                                 const std::string& place) {
  std::vector<double> values;
  for (const auto& text : range.list) {
    double value = 0;
    if (!files::parseNumber(text, value))
      throw core::InputError(place + ": found '" + text + "', expected a number");
    if (std::count(values.begin(), values.end(), value) > 0)
      throw core::InputError(place + ": '" + text + "' is given twice");
    values.push_back(value);
  }
  std::sort(values.begin(), values.end());
  if (!range.list.empty()) return values;
  const int steps = range.steps > 0 ? range.steps : steps_if_not_said;
  for (int i = 0; i < steps; ++i) {
    const double value = valueAt(range, static_cast<double>(i) / (steps - 1));
    values.push_back(whole ? std::round(value) : rounded(value, 6));
  }
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

std::string drawValue(const ValueRange& range, core::RandomStream& random) {
  if (!range.list.empty()) return range.list[random.below(range.list.size())];
  const double value = valueAt(range, random.uniform());
  return files::formatNumber(range.is_whole ? std::round(value) : rounded(value, 4));
}

}  // namespace slam::study
