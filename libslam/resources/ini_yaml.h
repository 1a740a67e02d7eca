#pragma once
#include <string>

#include "libslam/files/ini.h"

namespace slam::resources {

/// Whether a file is a configuration by its name: .ini, .yaml or .yml.
bool isConfigFile(const std::string& path);
/// Whether it is one in YAML by its name.
bool isYamlFile(const std::string& path);

/// A configuration written as YAML, as the .ini that it stands for:
///
///   suite:                     [suite]
///     worlds: [flat, office]   worlds = flat, office
///     seeds: 1..10             seeds = 1..10
///   lidar narrow:              [lidar narrow]
///     lidar: {fov_deg: 180}    lidar.fov_deg = 180
///
/// Lists are joined by ", ", maps within a section by ".". Values are taken as they are written, so that 0.10
/// stays 0.10. Origins are the YAML's lines. Errors: InputError with file and line for what is no YAML, a
/// second document, anything deeper, a key given twice, a value that an .ini cannot hold (a line break, " #",
/// " ;", in a list a comma). Read by yaml-cpp: MRPT 2.5.8's own reader returns the beginning of a broken file
/// without an error.
files::IniFile parseYaml(const std::string& text, const std::string& name);

/// Reads a configuration's file; what ends in .yaml or .yml as YAML. Errors: missing, a directory,
/// unreadable, malformed (InputError).
files::IniFile readConfigFile(const std::string& path);

}  // namespace slam::resources
