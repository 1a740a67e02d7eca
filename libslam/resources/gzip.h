#pragma once
#include <string>
#include <string_view>

namespace slam::resources {

/// RFC 1952, without time and name: the same bytes give the same bytes. Errors: IoError when there
/// is no memory for it.
std::string gzip(std::string_view bytes);

/// The same into a file, written beside and renamed, with no copy in memory. Errors: IoError.
void writeGzipFile(const std::string& path, std::string_view bytes);

}  // namespace slam::resources
