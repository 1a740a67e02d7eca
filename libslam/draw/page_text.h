#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace slam::draw {

/// Text as it may stand in HTML, between tags and in quoted attributes: & < > " ' escaped; bytes that are not
/// UTF-8 become U+FFFD, control characters blanks.
std::string htmlText(std::string_view utf8);
/// The same without escaping: valid UTF-8 on one line.
std::string plainText(std::string_view utf8);

/// RFC 4648, with padding, on one line.
std::string base64(std::string_view bytes);
/// The numbers' IEEE 754 singles, lowest byte first, as base64().
std::string base64Floats(const std::vector<double>& numbers);
/// data:TYPE;base64,...
std::string dataUri(const std::string& media_type, std::string_view bytes);

}  // namespace slam::draw
