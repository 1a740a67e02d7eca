#include "libslam/testing/temp_folder.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace slam::testing {
namespace fs = std::filesystem;

TempFolder::~TempFolder() {
  std::error_code ignored;
  fs::permissions(path(), fs::perms::owner_all, ignored);
}

std::vector<std::string> leftoversIn(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    if (name.find(".rasterslam-") != std::string::npos || entry.path().extension() == ".lock")
      names.push_back(name);
  }
  return names;
}

CommandResult runCommand(const std::string& shell_line) {
  const TempFolder folder;
  const std::string out = folder / "out", err = folder / "err";
  const int status =
      std::system(("{ " + shell_line + " ; } >'" + out + "' 2>'" + err + "' </dev/null").c_str());
  CommandResult result;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  const auto slurp = [](const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  result.out = slurp(out);
  result.err = slurp(err);
  return result;
}

bool programExists(const std::string& name) {
  return runCommand("command -v '" + name + "'").exit_code == 0;
}

std::string realDataFolder(const std::string& source_dir) {
  const char* given = std::getenv("RASTERSLAM_REAL_DATA");
  const fs::path folder = given ? fs::path(given) : fs::path(source_dir) / ".." / "shared" / "data";
  return fs::is_directory(folder) ? fs::weakly_canonical(folder).string() : "";
}

}  // namespace slam::testing
