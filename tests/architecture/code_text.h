#pragma once
#include <algorithm>
#include <cctype>
#include <string>

namespace slam::architecture {

/// C++ without comments and the insides of strings and characters; line by line as it was.
inline std::string codeOf(const std::string& text) {
  std::string code;
  for (std::size_t i = 0; i < text.size();) {
    std::size_t end = i + 1;
    if (text.compare(i, 2, "//") == 0) {
      end = std::min(text.find('\n', i), text.size());
    } else if (text.compare(i, 2, "/*") == 0) {
      end = std::min(text.find("*/", i), text.size() - 2) + 2;
    } else if (text.compare(i, 2, "R\"") == 0) {
      const std::size_t open = text.find('(', i);
      const std::string close = ")" + text.substr(i + 2, open - i - 2) + "\"";
      end = std::min(text.find(close, open), text.size() - close.size()) + close.size();
    } else if (text[i] == '"' || (text[i] == '\'' && (i == 0 || std::isalnum(text[i - 1]) == 0))) {
      while (end < text.size() && text[end] != text[i] && text[end] != '\n') end += text[end] == '\\' ? 2 : 1;
      ++end;
    } else {
      code += text[i];
    }
    if (end > i + 1)
      code.append(static_cast<std::size_t>(std::count(
                      text.begin() + static_cast<std::ptrdiff_t>(i),
                      text.begin() + static_cast<std::ptrdiff_t>(std::min(end, text.size())), '\n')),
                  '\n');
    i = end;
  }
  return code;
}

}  // namespace slam::architecture
