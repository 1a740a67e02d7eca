#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace slam::files {

/// Letters, not bytes: every byte of UTF-8 that does not continue a code point begins one.
std::size_t letters(std::string_view utf8);

/// What stands between white space.
std::vector<std::string> words(const std::string& text);

/// The words in lines of at most so many letters, one blank between two: the first line begins with `first`,
/// the others with `indent`, which count. A word that is too long has a line of its own. At least one line.
std::vector<std::string> wrapped(const std::string& text, std::size_t most_letters,
                                 const std::string& first = "", const std::string& indent = "");

}  // namespace slam::files
