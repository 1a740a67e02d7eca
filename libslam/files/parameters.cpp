#include "libslam/files/parameters.h"

#include <array>
#include <charconv>
#include <cmath>

#include "libslam/core/error.h"
#include "libslam/core/pose2.h"

namespace slam::files {
namespace {

bool endsWith(const std::string& text, const std::string& tail) {
  return text.size() > tail.size() && text.compare(text.size() - tail.size(), tail.size(), tail) == 0;
}

bool isInDegrees(const ParameterInfo& info) {
  return endsWith(info.key, "_deg") || endsWith(info.key, "_degps") || endsWith(info.key, "_degpm");
}

std::string rangeText(const ParameterInfo& info) {
  const bool low = std::isfinite(info.min), high = std::isfinite(info.max);
  if (low && high) return "from " + formatNumber(info.min) + " to " + formatNumber(info.max);
  if (low) return "of at least " + formatNumber(info.min);
  if (high) return "of at most " + formatNumber(info.max);
  return "that is finite";
}

std::string expectedText(const ParameterInfo& info) {
  if (std::holds_alternative<double>(info.default_value)) return "a number " + rangeText(info);
  if (std::holds_alternative<int>(info.default_value)) return "a whole number " + rangeText(info);
  if (std::holds_alternative<bool>(info.default_value)) return "true or false";
  std::string text = "one of";
  for (const auto& choice : info.choices) text += (text == "one of" ? " " : ", ") + choice;
  return text;
}

}  // namespace

std::string formatNumber(double value) {
  // 100000 rather than 1e+05; minus zero is left to to_chars, so that it reads back as itself.
  if (std::abs(value) < 1e15 && value == std::floor(value) && !(value == 0 && std::signbit(value)))
    return std::to_string(static_cast<long long>(value));
  std::array<char, 32> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), result.ptr};
}

bool parseNumber(const std::string& text, double& value) {
  const char* begin = text.data();
  const char* end = begin + text.size();
  if (begin != end && *begin == '+') ++begin;
  const auto result = std::from_chars(begin, end, value);
  return result.ec == std::errc() && result.ptr == end && std::isfinite(value);
}

namespace detail {

void assign(const ParameterPointer& target, const ParameterInfo& info, const ParameterValue& ini_value) {
  if (auto* const* number = std::get_if<double*>(&target)) {
    const double value = std::get<double>(ini_value);
    **number = isInDegrees(info) ? core::degToRad(value) : value;
  } else if (auto* const* whole = std::get_if<int*>(&target)) {
    **whole = std::get<int>(ini_value);
  } else if (auto* const* flag = std::get_if<bool*>(&target)) {
    **flag = std::get<bool>(ini_value);
  } else {
    *std::get<std::string*>(target) = std::get<std::string>(ini_value);
  }
}

std::string format(const ParameterPointer& value, const ParameterInfo& info) {
  if (auto* const* number = std::get_if<double*>(&value)) {
    if (!isInDegrees(info)) return formatNumber(**number);
    return formatNumber(std::round(core::radToDeg(**number) * 1e9) / 1e9);
  }
  if (auto* const* whole = std::get_if<int*>(&value)) return std::to_string(**whole);
  if (auto* const* flag = std::get_if<bool*>(&value)) return **flag ? "true" : "false";
  return *std::get<std::string*>(value);
}

ParameterValue parse(const std::string& text, const ParameterInfo& info, const std::string& section,
                     const std::string& origin) {
  const auto reject = [&]() {
    return core::InputError(origin + ": section [" + section + "], key '" + info.key + "': found '" + text +
                            "', expected " + expectedText(info));
  };
  if (std::holds_alternative<double>(info.default_value)) {
    double value = 0;
    if (!parseNumber(text, value) || value < info.min || value > info.max) throw reject();
    return value;
  }
  if (std::holds_alternative<int>(info.default_value)) {
    double value = 0;
    if (!parseNumber(text, value) || value != std::floor(value) || value < info.min || value > info.max ||
        std::abs(value) > 2147483647.0)
      throw reject();
    return static_cast<int>(value);
  }
  if (std::holds_alternative<bool>(info.default_value)) {
    if (text == "true") return true;
    if (text == "false") return false;
    throw reject();
  }
  if (info.choices.empty()) return text;
  for (const auto& choice : info.choices)
    if (text == choice) return text;
  throw core::InputError(std::string(reject().what()) + core::didYouMean(text, info.choices));
}

void rejectUnknownKeys(const IniFile& ini, const std::string& section,
                       const std::vector<std::string>& known) {
  const auto it = ini.sections().find(section);
  if (it == ini.sections().end()) return;
  for (const auto& [key, entry] : it->second) {
    bool found = false;
    for (const auto& k : known) found = found || k == key;
    if (!found)
      throw core::InputError(entry.origin + ": section [" + section + "], unknown key '" + key + "'" +
                             core::didYouMean(key, known));
  }
}

}  // namespace detail

void rejectUnknownSections(const IniFile& ini, const std::vector<std::string>& known) {
  for (const auto& [section, entries] : ini.sections()) {
    bool found = false;
    for (const auto& k : known) found = found || k == section;
    if (found) continue;
    const std::string where = entries.empty() ? "" : entries.begin()->second.origin + ": ";
    throw core::InputError(where + "unknown section [" + section + "]" + core::didYouMean(section, known));
  }
}

std::string formatParameterReport(const std::vector<ParameterReport>& report) {
  std::string text, section;
  for (const auto& line : report) {
    if (line.section != section) {
      text += (text.empty() ? "[" : "\n[") + line.section + "]\n";
      section = line.section;
    }
    std::string row = line.info.key + " = " + line.value;
    row.resize(std::max<size_t>(row.size() + 2, 40), ' ');
    text += row + "# " + line.origin + "; " + line.info.doc + "\n";
  }
  return text;
}

}  // namespace slam::files
