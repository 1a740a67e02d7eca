#pragma once
#include <string>
#include <vector>

namespace slam::files {

/// The parts between the separators, trimmed; empty ones among them, but for one behind the last separator.
/// "": none.
std::vector<std::string> splitAt(const std::string& text, char separator);
/// The same without the empty ones.
std::vector<std::string> namesIn(const std::string& text, char separator);

/// "3 2 90", "3,2,90" and "3, 2, 90" as their numbers: separated by blanks, by a comma, or by both. Empty
/// where a word is no number, where a comma has none on one of its sides, and for an empty text.
std::vector<double> parseNumberList(const std::string& text);

}  // namespace slam::files
