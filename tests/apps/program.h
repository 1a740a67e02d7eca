#pragma once
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "libslam/testing/temp_folder.h"

namespace slam::apps {

/// Runs `rasterslam ARGUMENTS` (a shell line) in a folder.
inline testing::CommandResult rasterslam(const std::string& arguments, const std::string& folder = "/tmp") {
  return testing::runCommand("cd '" + folder + "' && '" RASTERSLAM_PROGRAM "' " + arguments);
}

/// Tests whose commands run in one folder, which the suite fills first.
class CommandsInAFolder : public ::testing::Test {
 protected:
  static void fill(const std::vector<std::string>& commands) {
    shared_folder = new testing::TempFolder;
    for (const std::string& command : commands) {
      const auto made = run(command);
      ASSERT_EQ(made.exit_code, 0) << command << ": " << made.err;
    }
  }
  static void TearDownTestSuite() {
    delete shared_folder;
    shared_folder = nullptr;
  }
  static testing::CommandResult run(const std::string& arguments) {
    return rasterslam(arguments, shared_folder->path());
  }
  inline static testing::TempFolder* shared_folder = nullptr;
};

}  // namespace slam::apps
