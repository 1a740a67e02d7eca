#pragma once
#include <string>

#include "libslam/files/ini.h"

namespace slam::files {

/// The sections and keys in alphabetical order; IniFile::parse() reads the same values back. REQUIRES what it
/// could have read (no line breaks and no comments in names or values).
std::string toText(const IniFile& ini);

}  // namespace slam::files
