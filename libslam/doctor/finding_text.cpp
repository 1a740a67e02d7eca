#include "libslam/doctor/finding_text.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>

namespace slam::doctor {

std::string text(const char* format, ...) {
  std::va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  const int length = std::vsnprintf(nullptr, 0, format, arguments);
  va_end(arguments);
  std::string result(static_cast<std::size_t>(std::max(length, 0)) + 1, '\0');
  std::vsnprintf(result.data(), result.size(), format, again);
  va_end(again);
  result.pop_back();
  return result;
}

unsigned long n(std::uint64_t count) {
  return static_cast<unsigned long>(count);
}

double share(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

std::string plural(std::uint64_t count, const char* one, const char* more) {
  return std::to_string(count) + " " + (count == 1 ? one : more);
}

std::string shown(const calibration::Estimate& e, double factor, int decimals) {
  const double a = std::min(e.low * factor, e.high * factor), b = std::max(e.low * factor, e.high * factor);
  return text("%.*f (%.*f to %.*f)", decimals, e.value * factor, decimals, a, decimals, b);
}

std::string beamList(const std::vector<int>& beams) {
  std::string list;
  int runs = 0;
  for (std::size_t i = 0; i < beams.size();) {
    std::size_t last = i;
    while (last + 1 < beams.size() && beams[last + 1] == beams[last] + 1) ++last;
    if (++runs > 6) return list + ", ...";
    list += (list.empty() ? "" : ", ") + std::to_string(beams[i]);
    if (last > i) list += " to " + std::to_string(beams[last]);
    i = last + 1;
  }
  return list;
}

}  // namespace slam::doctor
