#include "libslam/truth/cut_truth.h"

#include <algorithm>
#include <filesystem>

#include "libslam/logs/log_reader.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/manifest.h"
#include "libslam/truth/truth_files.h"

namespace slam::truth {

std::vector<std::string> keepTruth(const std::string& whole_log, const std::string& part_log) {
  const auto truth_path = findTruth(whole_log);
  if (std::filesystem::path(truth_path).extension() != ".tum") return {};
  const std::string part_truth = besideLog(part_log, ".gt.tum"),
                    part_manifest = besideLog(part_log, ".manifest.json");
  const auto part = logs::inspectLog(part_log);
  constexpr double kSlack_s = 1e-6;
  core::Trajectory truth;
  for (const auto& pose : logs::readTrajectory(truth_path))
    if (pose.time_s >= part.first_time_s - kSlack_s && pose.time_s <= part.last_time_s + kSlack_s)
      truth.push_back(pose);
  logs::writeTum(truth, part_truth);
  std::vector<std::string> written = {part_truth};
  if (const auto plan = findPlan(whole_log); !plan.empty()) {
    resources::Manifest manifest;
    manifest.inputs[plan] = resources::fileSha256(plan);
    manifest.files[std::filesystem::path(part_truth).filename()] = "truth: poses of the robot, world frame";
    resources::writeManifest(manifest, part_manifest);
    written.push_back(part_manifest);
  }
  return written;
}

}  // namespace slam::truth
