#pragma once
#include <string>
#include <string_view>

namespace slam::resources {

/// SHA-256 of a file's bytes as 64 hexadecimal digits.
std::string fileSha256(const std::string& path);
std::string sha256(std::string_view bytes);

}  // namespace slam::resources
