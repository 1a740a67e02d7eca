#pragma once
#include <array>
#include <charconv>
#include <string>
#include <string_view>

namespace slam::core {

/// Appends a number with so many decimals, whatever the locale; never "-0.000".
inline void appendFixed(std::string& text, double value, int decimals) {
  // Fixed notation of the largest double has 309 digits before the point.
  std::array<char, 400> buffer{};
  const auto result =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::fixed, decimals);
  std::string_view digits(buffer.data(), static_cast<size_t>(result.ptr - buffer.data()));
  // "-0.000" would make equal poses differ in their bytes.
  if (digits.front() == '-' && digits.find_first_not_of("-0.") == std::string_view::npos)
    digits.remove_prefix(1);
  text += digits;
}

}  // namespace slam::core
