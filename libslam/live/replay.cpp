#include "libslam/live/replay.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/files/parameters.h"
#include "libslam/logs/log_reader.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/resources.h"
#include "libslam/results/journal_file.h"
#include "libslam/score/evaluate.h"

namespace slam::live {
namespace fs = std::filesystem;
namespace {

constexpr double kSameStamp_s = 2e-6;  // trajectories are written with microseconds

/// The log that a run was made from, with its hash.
std::pair<std::string, std::string> logOf(const results::RunFolder& run) {
  const std::string own = run.path + "/run.rawlog";
  if (fs::exists(own)) return {own, ""};
  const auto& inputs = run.manifest.inputs;
  if (const auto input = inputs.find(results::logInput(run.manifest)); input != inputs.end()) return *input;
  throw core::InputError(run.path + "/manifest.json: names no log that the run was made from; give --log");
}

}  // namespace

Replay loadReplay(const std::string& folder, const std::string& given_log) {
  const auto run = results::loadRun(folder);
  const auto [log_path, hash] = logOf(run);
  Replay replay;
  replay.log_path = given_log.empty() ? log_path : given_log;
  if (!fs::exists(replay.log_path))
    throw core::InputError(replay.log_path + ": the log of " + folder + " is not there; give --log");
  if (!hash.empty() && resources::fileSha256(replay.log_path) != hash)
    throw core::InputError(replay.log_path + ": is not the log that " + folder +
                           " was made from (its SHA-256 is another)");
  replay.method = run.method;
  replay.path = run.final_estimate.value_or(run.estimate);
  const std::string journal = folder + "/journal.csv";
  if (!fs::exists(journal)) return replay;
  const core::Pose2 T_first_map = core::inverse(replay.path.front().pose);
  for (const auto& line : results::readJournal(journal))
    if (line.event == core::JournalEvent::kAccepted)
      replay.loops.push_back({line.scan, {T_first_map * line.place, T_first_map * line.other_place}});
  return replay;
}

void play(const Replay& replay, record::StepObserver& observer) {
  auto config = mapping::loadMethodConfig(resources::configsFolder() + "/methods", "naive_wheel");
  auto method = mapping::makeMapBuilder(config, "naive_wheel", 1);
  logs::LogReader log(replay.log_path);
  core::Pose2 T_map_previous = replay.path.front().pose;
  const core::Pose2 T_map_first = T_map_previous;
  double begin_s = 0;
  bool is_first = true;
  while (const auto entry = log.next()) {
    const double time_s = entry->scan.time_s;
    const auto at =
        std::lower_bound(replay.path.begin(), replay.path.end(), time_s - kSameStamp_s,
                         [](const core::StampedPose& pose, double stamp_s) { return pose.time_s < stamp_s; });
    if (at == replay.path.end() || at->time_s > time_s + kSameStamp_s)
      throw core::InputError(replay.log_path + ": the scan at " + files::formatNumber(time_s) +
                             " s has no pose in the run's path, expected one each");
    if (is_first) begin_s = time_s;
    is_first = false;
    mapping::processScan(method, entry->scan, core::between(T_map_previous, at->pose), true);
    // The builder's own frame is the robot's pose at the first scan.
    observer.onStep({time_s - begin_s, entry->scan, entry->T_previous_robot,
                     core::between(T_map_first, at->pose), &method});
    T_map_previous = at->pose;
  }
  if (is_first) throw core::InputError(replay.log_path + ": holds 0 laser scans, expected at least 1");
}

}  // namespace slam::live
