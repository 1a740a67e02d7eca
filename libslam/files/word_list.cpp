#include "libslam/files/word_list.h"

#include <sstream>
#include <utility>

#include "libslam/files/ini.h"
#include "libslam/files/parameters.h"

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

std::vector<double> parseNumberList(const std::string& text) {
  std::vector<double> numbers;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    std::istringstream words(part);
    const auto before = numbers.size();
    for (std::string word; words >> word;) {
      double number = 0;
      if (!parseNumber(word, number)) return {};
      numbers.push_back(number);
    }
    if (numbers.size() == before) return {};
  }
  if (!text.empty() && text.back() == ',') return {};
  return numbers;
}

}  // namespace slam::files
