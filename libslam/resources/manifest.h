#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace slam::resources {

/// What made an output folder, so that anyone can make it again: written as manifest.json into it.
struct Manifest {
  std::string version;                    ///< of rasterslam; written by writeManifest()
  std::vector<std::string> command_line;  ///< argv
  std::uint64_t seed = 0;
  std::map<std::string, std::string> config;   ///< "section.key" -> value, all of them
  std::map<std::string, std::string> inputs;   ///< path -> SHA-256
  std::map<std::string, std::string> files;    ///< file in the folder -> what it is and what opens it
  std::map<std::string, double> times_s;       ///< stage -> seconds of wall time
  std::map<std::string, std::string> results;  ///< short facts, such as "scans" -> "224"
};

/// Adds the versions of rasterslam, the compiler and the build type, and writes the JSON (atomically).
/// The keys stand in a fixed order. Errors: IoError.
void writeManifest(const Manifest& manifest, const std::string& path);
/// Reads back what writeManifest wrote. Errors: InputError with the path and the key.
Manifest readManifest(const std::string& path);

/// argv as one line that a POSIX shell reads back as the same words.
std::string shellQuoted(const std::vector<std::string>& command_line);

/// "0.2.0"
std::string versionText();

}  // namespace slam::resources
