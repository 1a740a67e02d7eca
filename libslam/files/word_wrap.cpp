#include "libslam/files/word_wrap.h"

#include <algorithm>
#include <sstream>
#include <utility>

namespace slam::files {

std::size_t letters(std::string_view utf8) {
  return static_cast<std::size_t>(
      std::count_if(utf8.begin(), utf8.end(), [](unsigned char c) { return (c & 0xC0) != 0x80; }));
}

std::vector<std::string> words(const std::string& text) {
  std::vector<std::string> all;
  std::istringstream in(text);
  for (std::string word; in >> word;) all.push_back(std::move(word));
  return all;
}

std::vector<std::string> wrapped(const std::string& text, std::size_t most_letters, const std::string& first,
                                 const std::string& indent) {
  std::vector<std::string> lines = {first};
  bool has_word = false;
  for (const auto& word : words(text)) {
    if (has_word && letters(lines.back()) + 1 + letters(word) > most_letters) {
      lines.push_back(indent);
      has_word = false;
    }
    lines.back() += (has_word ? " " : "") + word;
    has_word = true;
  }
  return lines;
}

}  // namespace slam::files
