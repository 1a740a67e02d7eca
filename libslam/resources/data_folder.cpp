#include "libslam/resources/data_folder.h"

#include <dlfcn.h>
#include <sys/auxv.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <vector>

#include "libslam/core/error.h"

namespace slam::resources {
namespace fs = std::filesystem;
namespace {

const char* const kVariable = "RASTERSLAM_DATA";

std::string versionIn(const std::string& folder) {
  std::ifstream in(fs::path(folder) / "VERSION");
  std::string version;
  std::getline(in, version);
  return version;
}

/// Why the folder cannot be taken; "" when it can.
std::string faultOf(const std::string& folder, const std::string& version) {
  std::error_code error;
  for (const char* part : {"configs", "worlds"})
    if (!fs::is_directory(fs::path(folder) / part, error))
      return std::string("found no folder '") + part + "' in it";
  const std::string found = versionIn(folder);
  if (found.empty()) return "found no file VERSION in it";
  return found == version ? "" : "found data of version " + found;
}

DataFolders installedData(const std::string& folder) {
  return {folder + "/configs", folder + "/worlds", folder + "/learn", folder + "/public_data.json"};
}

/// share/rasterslam of every prefix that the code could have been installed under.
std::vector<std::string> besideCode(const std::string& code) {
  std::vector<std::string> folders;
  fs::path prefix = fs::path(code).parent_path();
  for (int up = 0; up < 2 && prefix.has_relative_path(); ++up) {
    prefix = prefix.parent_path();
    folders.push_back((prefix / "share" / "rasterslam").string());
  }
  return folders;
}

bool isBelow(const std::string& path, const std::string& folder) {
  return !folder.empty() && path.compare(0, folder.size() + 1, folder + "/") == 0;
}

/// The file that holds this code: a shared library by the loader's list, else the program.
std::string codePath() {
  std::error_code error;
  Dl_info here = {}, program = {};
  const auto entry = reinterpret_cast<const void*>(getauxval(AT_ENTRY));
  if (dladdr(reinterpret_cast<const void*>(&dataPlaces), &here) != 0 && dladdr(entry, &program) != 0 &&
      here.dli_fbase != program.dli_fbase) {
    const auto library = fs::canonical(here.dli_fname, error);
    if (!error) return library.string();
  }
  const auto path = fs::read_symlink("/proc/self/exe", error);
  return error ? "" : path.string();
}

std::string resolved(const std::string& folder) {
  std::error_code error;
  const auto path = fs::canonical(folder, error);
  return error ? folder : path.string();
}

}  // namespace

DataPlaces dataPlaces() {
  const char* given = std::getenv(kVariable);
  return {given ? given : "", codePath(), resolved(RASTERSLAM_BUILD_DIR), RASTERSLAM_SOURCE_DIR,
          RASTERSLAM_INSTALL_DIR};
}

DataFolders findData(const DataPlaces& places, const std::string& version) {
  if (!places.given.empty()) {
    const std::string fault = faultOf(places.given, version);
    if (fault.empty()) return installedData(places.given);
    throw core::InputError(std::string(kVariable) + ": " + places.given + ": " + fault +
                           ", expected the data of rasterslam " + version);
  }
  std::string looked;
  const auto take = [&](const std::string& folder) {
    const std::string fault = faultOf(folder, version);
    if (fault.empty()) return true;
    std::error_code error;
    if (fs::exists(folder, error))
      throw core::InputError(folder + ": " + fault + ", expected the data of rasterslam " + version);
    looked += (looked.empty() ? "" : ", ") + folder;
    return false;
  };
  for (const auto& folder : besideCode(places.code))
    if (take(folder)) return installedData(folder);
  if (isBelow(places.code, places.build_folder)) {
    const fs::path source = places.source_folder;
    DataFolders data = {(source / "configs").string(), (source / "datasets" / "worlds").string(),
                        (source / "docs" / "learn").string(),
                        (source / "datasets" / "public_data.json").string()};
    std::error_code error;
    if (fs::is_directory(data.configs, error) && fs::is_directory(data.worlds, error)) return data;
    looked += (looked.empty() ? "" : ", ") + places.source_folder;
  }
  if (!places.installed.empty() && take(places.installed)) return installedData(places.installed);
  throw core::InputError("the data of rasterslam " + version + " is missing; looked at " + looked + "; " +
                         kVariable + " can name its folder");
}

}  // namespace slam::resources
