#pragma once
#include <string>

#include "libslam/testing/temp_folder.h"

namespace slam::apps {

/// Runs `rasterslam ARGUMENTS` (a shell line) in a folder.
inline testing::CommandResult rasterslam(const std::string& arguments, const std::string& folder = "/tmp") {
  return testing::runCommand("cd '" + folder + "' && '" RASTERSLAM_PROGRAM "' " + arguments);
}

}  // namespace slam::apps
