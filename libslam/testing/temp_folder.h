#pragma once
#include <string>
#include <vector>

#include "libslam/files/files.h"

namespace slam::testing {

/// A fresh folder for one test, removed with everything in it, also where the test took its permissions away.
class TempFolder : public files::ScratchFolder {
 public:
  TempFolder() = default;
  ~TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;
};

/// What a folder, and all below it, holds of outputs that were not finished: names of files::PendingFile and
/// files::OutputLock.
std::vector<std::string> leftoversIn(const std::string& folder);

/// What a program printed and how it ended. The command is a shell line; standard input is /dev/null.
struct CommandResult {
  int exit_code = -1;  ///< 128 + signal when killed
  std::string out, err;
};
CommandResult runCommand(const std::string& shell_line);

/// True when the program is on the PATH.
bool programExists(const std::string& name);

/// $RASTERSLAM_REAL_DATA or ../shared/data beside the source tree: real logs and plans; empty when absent,
/// and then a test that needs it skips.
std::string realDataFolder(const std::string& source_dir);

}  // namespace slam::testing
