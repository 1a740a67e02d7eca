#pragma once
#include <string>
#include <vector>

namespace slam::files {

/// "3 2 90", "3,2,90" and "3, 2, 90" as their numbers: separated by blanks, by a comma, or by both. Empty
/// where a word is no number, where a comma has none on one of its sides, and for an empty text.
std::vector<double> parseNumberList(const std::string& text);

}  // namespace slam::files
