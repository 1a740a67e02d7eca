#include "libslam/results/run_folder.h"

#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/files/parameters.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/resources/resources.h"

namespace slam::results {
namespace {

using core::kNaN;

double timeOf(const resources::Manifest& manifest, const std::string& key) {
  const auto it = manifest.times_s.find(key);
  return it == manifest.times_s.end() ? kNaN : it->second;
}

/// None where the file is not there.
std::vector<StampedCovariance> covariancesOf(const core::Trajectory& poses, const std::string& path) {
  if (!std::filesystem::exists(path)) return {};
  auto covariances = readCovariances(path);
  if (!covariances.empty() && covariances.size() != poses.size())
    throw core::InputError(path + ": found " + std::to_string(covariances.size()) +
                           " covariances, expected one for each of the " + std::to_string(poses.size()) +
                           " poses");
  return covariances;
}

}  // namespace

double resultOf(const resources::Manifest& manifest, const std::string& key, const std::string& path) {
  const auto it = manifest.results.find(key);
  if (it == manifest.results.end())
    throw core::InputError(path + "/manifest.json: key 'results." + key + "' is missing");
  double value = kNaN;
  files::parseNumber(it->second, value);  // "nan" stays NaN
  return value;
}

double resultIfThere(const resources::Manifest& manifest, const std::string& key) {
  const auto it = manifest.results.find(key);
  double value = kNaN;
  if (it != manifest.results.end()) files::parseNumber(it->second, value);
  return value;
}

RunFolder loadRun(const std::string& folder) {
  RunFolder run;
  run.path = folder;
  run.manifest = resources::readManifest(folder + "/manifest.json");
  const auto method = run.manifest.results.find("method");
  if (method == run.manifest.results.end())
    throw core::InputError(folder + ": is not the folder of one method's run (its manifest names no method)");
  run.method = method->second;
  run.estimate = logs::readTum(folder + "/trajectory.tum");
  const std::string final_path = folder + "/trajectory_final.tum";
  if (std::filesystem::exists(final_path)) run.final_estimate = logs::readTum(final_path);
  run.covariances = covariancesOf(run.estimate, folder + "/covariances.csv");
  if (run.final_estimate)
    run.final_covariances = covariancesOf(*run.final_estimate, folder + "/covariances_final.csv");
  if (const std::string relative = folder + "/covariances_relative.csv"; std::filesystem::exists(relative))
    run.relative_covariances = readRelativeCovariances(relative);
  run.map = world::loadCellMap(folder + "/map.yaml");
  run.cost = {timeOf(run.manifest, "mean_ms_per_scan"), timeOf(run.manifest, "p99_ms_per_scan"),
              resultOf(run.manifest, "peak_memory_mb", folder), timeOf(run.manifest, "real_time_factor")};
  return run;
}

std::string logInput(const resources::Manifest& manifest) {
  if (const auto named = manifest.results.find("log"); named != manifest.results.end()) return named->second;
  for (const auto& [path, hash] : manifest.inputs) {
    const auto suffix = std::filesystem::path(path).extension().string();
    if (suffix != ".simplemap" && suffix != ".ini" && !resources::looksLikePlan(path)) return path;
  }
  return "";
}

}  // namespace slam::results
