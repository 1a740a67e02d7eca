#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libslam/core/progress.h"
#include "libslam/files/ini.h"
#include "libslam/resources/manifest.h"
#include "libslam/score/compare.h"

namespace slam::score {

/// A method of a comparison.
struct ComparedMethod {
  std::string name, argument, folder;  // argument: as the request names it
  files::IniFile config;
  std::vector<std::string> settings;  // of the request, for this method
  std::string failure;                ///< why it has no figures; empty: it has
  bool reused = false;                ///< what lies there is taken
};

/// Those of the request, with its settings, checked. Errors: InputError.
std::vector<ComparedMethod> loadMethods(const CompareRequest& request);

/// True when the folder holds a finished run of the same method on the same log with the same seed and
/// program.
bool isSameRun(const ComparedMethod& method, const std::string& log_path, std::uint64_t seed);

/// Runs those that are not reused side by side, each in a process of its own where the request names the
/// program; each is independent, so the number of threads changes nothing but the time. What goes wrong with
/// a method alone is its failure.
void runMethods(std::vector<ComparedMethod>& methods, const std::string& log_path,
                const CompareRequest& request, const resources::Manifest& manifest, core::Progress& progress);

}  // namespace slam::score
