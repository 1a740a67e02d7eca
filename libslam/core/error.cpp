#include "libslam/core/error.h"

#include <algorithm>
#include <numeric>

namespace slam::core {
namespace {

size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row[b.size()];
}

/// Bytes of the UTF-8 letter that a text begins with; 0: it begins with none, or with a control character.
std::size_t letterLength(std::string_view text) {
  const auto at = [&](std::size_t i) -> unsigned {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0;
  };
  const unsigned lead = at(0);
  if (lead < 0x80) return lead >= 0x20 && lead != 0x7F ? 1 : 0;
  const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((at(i) & 0xC0U) != 0x80) return 0;
  // Overlong forms, surrogates, beyond Unicode, and the control characters U+0080 to U+009F.
  const unsigned next = at(1);
  const bool is_wrong = (lead == 0xC2 && next < 0xA0) || (lead == 0xE0 && next < 0xA0) ||
                        (lead == 0xED && next >= 0xA0) || (lead == 0xF0 && next < 0x90) ||
                        (lead == 0xF4 && next >= 0x90);
  return is_wrong ? 0 : length;
}

std::string escaped(char byte) {
  constexpr const char* kDigits = "0123456789abcdef";
  const auto value = static_cast<unsigned char>(byte);
  return {'\\', 'x', kDigits[value >> 4U], kDigits[value & 15U]};
}

}  // namespace

std::string printable(std::string_view text) {
  std::string shown;
  shown.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = text[i] == '\n' || text[i] == '\t' ? 1 : letterLength(text.substr(i));
    if (length > 0)
      shown += text.substr(i, length);
    else
      shown += escaped(text[i]);
    i += std::max<std::size_t>(length, 1);
  }
  return shown;
}

std::string oneLine(std::string_view message, std::size_t most) {
  constexpr std::string_view kLeftOut = " ... ";
  // Pieces that are not to be torn: a letter, or a byte that is shown by its number.
  std::vector<std::string> pieces;
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < message.size();) {
    const std::size_t length = letterLength(message.substr(i));
    if (message[i] == '\n' || message[i] == '\t' || message[i] == '\r') {
      pieces.emplace_back(" ");
    } else if (length == 0) {
      pieces.push_back(escaped(message[i]));
    } else {
      pieces.emplace_back(message.substr(i, length));
    }
    i += std::max<std::size_t>(length, 1);
    bytes += pieces.back().size();
  }
  std::string head, tail;
  std::size_t first = 0, last = pieces.size();
  const std::size_t room = bytes <= most ? most : most - std::min(most, kLeftOut.size());
  // The end of a message tells what was expected: a third of what is kept.
  while (bytes > most && last > first && tail.size() + pieces[last - 1].size() <= room / 3)
    tail.insert(0, pieces[--last]);
  while (first < last && head.size() + pieces[first].size() + tail.size() <= room) head += pieces[first++];
  return bytes <= most ? head : head.append(kLeftOut) + tail;
}

std::string didYouMean(std::string_view word, const std::vector<std::string>& candidates) {
  size_t best = (word.size() + 2) / 3 + 1;
  const std::string* nearest = nullptr;
  for (const auto& candidate : candidates) {
    const size_t d = editDistance(word, candidate);
    if (d < best) {
      best = d;
      nearest = &candidate;
    }
  }
  return nearest ? "; did you mean '" + *nearest + "'?" : "";
}

}  // namespace slam::core
