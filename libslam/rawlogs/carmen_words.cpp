#include "libslam/rawlogs/carmen_words.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>

#include "libslam/core/error.h"
#include "libslam/files/parameters.h"

namespace slam::rawlogs {
namespace {

constexpr double kYear10000_s = 253'402'300'800.0;

}  // namespace

bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

std::string shownWord(std::string_view word) {
  constexpr size_t kMost = 40;
  return core::oneLine(word, kMost);
}

std::string quoted(std::string_view word) {
  return "'" + shownWord(word) + "'";
}

bool parse(std::string_view word, double& value) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
  return result.ec == std::errc() && result.ptr == word.data() + word.size() && std::isfinite(value);
}

std::string_view CarmenWords::next() {
  size_t begin = 0;
  while (begin < rest_.size() && isBlank(rest_[begin])) ++begin;
  size_t end = begin;
  while (end < rest_.size() && !isBlank(rest_[end])) ++end;
  const std::string_view word = rest_.substr(begin, end - begin);
  rest_.remove_prefix(end);
  return word;
}

std::string_view CarmenWords::word(const char* expected) {
  const auto found = next();
  if (found.empty()) throw core::InputError("found the end of the line, expected " + std::string(expected));
  return found;
}

double CarmenWords::number(const char* expected) {
  const auto found = word(expected);
  double value = 0;
  if (!parse(found, value))
    throw core::InputError("found " + quoted(found) + ", expected " + expected + " (a finite number)");
  return value;
}

core::Pose2 CarmenWords::pose(const char* expected) {
  const double x = number(expected), y = number(expected);
  return {x, y, number(expected)};
}

size_t CarmenWords::count(const char* expected) {
  const auto found = word(expected);
  size_t value = 0;
  const auto result = std::from_chars(found.data(), found.data() + found.size(), value);
  if (result.ec != std::errc() || result.ptr != found.data() + found.size() || value > rest_.size())
    throw core::InputError("found " + quoted(found) + ", expected " + expected +
                           " (a whole number, at most as many as the line has)");
  return value;
}

double CarmenWords::stamp() {
  const auto found = word("ipc_timestamp");
  double time_s = 0;
  if (!parse(found, time_s) || time_s < 0 || time_s >= kYear10000_s)
    throw core::InputError("found " + quoted(found) +
                           ", expected ipc_timestamp (seconds since 1970, before the year 10000)");
  return time_s;
}

std::string CarmenWords::tail() {
  std::string host(word("ipc_hostname"));
  number("logger_timestamp");
  const auto more = next();
  if (!more.empty()) throw core::InputError("found " + quoted(more) + ", expected the end of the line");
  return host;
}

}  // namespace slam::rawlogs
