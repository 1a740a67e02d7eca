#include "libslam/files/number_list.h"

#include <sstream>

#include "libslam/files/parameters.h"

namespace slam::files {

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
