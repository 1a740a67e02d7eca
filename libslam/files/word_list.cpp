#include "libslam/files/word_list.h"

#include <sstream>
#include <utility>

#include "libslam/files/ini.h"

namespace slam::files {

std::vector<std::string> splitAt(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, separator);) parts.push_back(trimmed(part));
  return parts;
}

std::vector<std::string> namesIn(const std::string& text, char separator) {
  std::vector<std::string> names;
  for (auto& part : splitAt(text, separator))
    if (!part.empty()) names.push_back(std::move(part));
  return names;
}

}  // namespace slam::files
