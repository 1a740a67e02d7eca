#pragma once
#include <string>
#include <vector>

namespace slam::files {

/// The parts between the separators, trimmed; empty ones among them, but for one behind the last separator.
/// "": none.
std::vector<std::string> splitAt(const std::string& text, char separator);
/// The same without the empty ones.
std::vector<std::string> namesIn(const std::string& text, char separator);

}  // namespace slam::files
