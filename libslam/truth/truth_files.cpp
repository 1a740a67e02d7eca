#include "libslam/truth/truth_files.h"

#include <filesystem>

#include "libslam/logs/log_format.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/manifest.h"
#include "libslam/resources/resources.h"

namespace slam::truth {
namespace fs = std::filesystem;

std::string besideLog(const std::string& log_or_truth_path, const std::string& ending) {
  std::string stem = log_or_truth_path;
  for (const std::string suffix : {".gt.tum", ".GT.txt"})
    if (stem.size() > suffix.size() && stem.compare(stem.size() - suffix.size(), suffix.size(), suffix) == 0)
      stem.resize(stem.size() - suffix.size());
  const fs::path path(stem);
  return (path.extension() == ".rawlog" ? (path.parent_path() / path.stem()).string() : stem) + ending;
}

std::string findTruth(const std::string& log_path) {
  for (const auto& path :
       {besideLog(log_path, ".gt.tum"), logs::logStem(log_path) + ".truth.tum", log_path + ".GT.txt"})
    if (fs::exists(path)) return path;
  return "";
}

std::string findPlan(const std::string& log_path) {
  const std::string path = besideLog(log_path, ".manifest.json");
  if (!fs::exists(path)) return "";
  const auto manifest = resources::readManifest(path);
  std::string own = besideLog(log_path, ".plan.yaml");
  if (manifest.files.count(fs::path(own).filename().string()) > 0 && fs::exists(own)) return own;
  for (const auto& [input, hash] : manifest.inputs)
    if (resources::looksLikePlan(input) && fs::exists(input) && resources::fileSha256(input) == hash)
      return input;
  return "";
}

TruthFiles truthFiles(const std::string& log_path, const std::string& given_trajectory,
                      const std::string& given_plan) {
  TruthFiles files{given_trajectory.empty() ? findTruth(log_path) : given_trajectory,
                   given_plan.empty() ? findPlan(log_path) : given_plan};
  // MRPT's own form of the truth starts at the origin: it cannot be laid on the plan.
  if (fs::path(files.trajectory).extension() != ".tum") files.plan.clear();
  return files;
}

}  // namespace slam::truth
