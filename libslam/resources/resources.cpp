#include "libslam/resources/resources.h"

#include <algorithm>
#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/resources/data_folder.h"
#include "libslam/resources/manifest.h"

namespace slam::resources {
namespace fs = std::filesystem;
namespace {

DataFolders ourData() {
  return findData(dataPlaces(), versionText());
}

std::string suffixOf(const std::string& path) {
  std::string suffix = fs::path(path).extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return suffix;
}

}  // namespace

std::string configsFolder() {
  return ourData().configs;
}

std::string worldsFolder() {
  return ourData().worlds;
}

std::string publicDataFile() {
  return ourData().public_data;
}

std::string mrptDatasetsFolder() {
  const std::string folder = "/usr/share/mrpt/datasets";
  return fs::is_directory(folder) ? folder : "";
}

std::vector<std::string> namesInFolder(const std::string& folder, const std::string& suffix) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == suffix) names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string resolvePlan(const std::string& path_or_name) {
  const bool is_name = path_or_name.find_first_of("/.") == std::string::npos;
  // A folder of results may be called as a world is.
  if (fs::exists(path_or_name) && !(is_name && fs::is_directory(path_or_name))) return path_or_name;
  if (!is_name) throw core::InputError(path_or_name + ": no such file");
  const auto names = namesInFolder(worldsFolder(), ".yaml");
  for (const auto& name : names)
    if (name == path_or_name) return worldsFolder() + "/" + name + ".yaml";
  if (fs::exists(path_or_name)) return path_or_name;
  throw core::InputError(path_or_name + ": no such file and no world of that name" +
                         core::didYouMean(path_or_name, names));
}

bool looksLikePlan(const std::string& path_or_name) {
  const std::string suffix = suffixOf(path_or_name);
  for (const char* known : {".yaml", ".yml", ".bmp", ".png", ".pgm", ".jpg", ".jpeg"})
    if (suffix == known) return true;
  return suffix.empty() && !fs::exists(path_or_name);
}

}  // namespace slam::resources
