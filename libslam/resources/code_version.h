#pragma once
#include <string>

namespace slam::resources {

/// "0.2.0-3f2a91c07b44": the version and a hash of the library's sources. Two programs with the same text
/// were made from the same code, whatever the build type and the machine; the libraries that they link are
/// not in it.
std::string codeVersion();

}  // namespace slam::resources
