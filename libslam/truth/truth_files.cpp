#include "libslam/truth/truth_files.h"

#include <filesystem>

#include "libslam/logs/convert.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/manifest.h"
#include "libslam/resources/resources.h"

namespace slam::truth {
namespace fs = std::filesystem;

std::string logStem(const std::string& log_path) {
  const std::filesystem::path path(log_path);
  return path.extension() == ".rawlog" ? (path.parent_path() / path.stem()).string() : log_path;
}

std::string findTruth(const std::string& log_path) {
  for (const auto& path :
       {logStem(log_path) + ".gt.tum", logs::logStem(log_path) + ".truth.tum", log_path + ".GT.txt"})
    if (fs::exists(path)) return path;
  return "";
}

std::string findPlan(const std::string& log_path) {
  const std::string path = logStem(log_path) + ".manifest.json";
  if (!fs::exists(path)) return "";
  const auto manifest = resources::readManifest(path);
  std::string own = logStem(log_path) + ".plan.yaml";
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
