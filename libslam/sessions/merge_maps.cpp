#include "libslam/sessions/merge_maps.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/mapping/key_frames.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/resources/file_hash.h"
#include "libslam/results/manifest_entries.h"
#include "libslam/results/scene_file.h"

namespace slam::sessions {
namespace {

namespace fs = std::filesystem;
using mapping::KeyFrame;

constexpr double kRounded_s = 1e-5, kRounded_m = 1e-3;  ///< of stamps and poses in files

/// Scans of one stamp, in logs whose stamps run back, may stand for one another.
constexpr double kFitting = 0.9;

/// Whether a path was given with the key frames as they are, and not before they were corrected.
bool fits(const core::Trajectory& path, const std::vector<KeyFrame>& key_frames) {
  if (path.empty()) return false;
  const auto fitting = std::count_if(key_frames.begin(), key_frames.end(), [&](const KeyFrame& frame) {
    const auto same =
        std::lower_bound(path.begin(), path.end(), frame.scan.time_s - kRounded_s,
                         [](const core::StampedPose& pose, double time_s) { return pose.time_s < time_s; });
    return same != path.end() && core::distance(same->pose, frame.T_map_robot) < kRounded_m;
  });
  return static_cast<double>(fitting) >= kFitting * static_cast<double>(key_frames.size());
}

/// The path of a session where its key frames have moved: every pose goes with the key frame before it.
core::Trajectory movedPath(const Session& session, const std::vector<KeyFrame>& before,
                           const std::vector<KeyFrame>& after) {
  core::Trajectory path;
  if (!fits(session.estimate, before)) {
    for (size_t k = 0; k < before.size(); ++k) path.push_back({before[k].scan.time_s, after[k].T_map_robot});
  } else {
    std::vector<std::pair<double, size_t>> stamps;
    for (size_t k = 0; k < before.size(); ++k) stamps.push_back({before[k].scan.time_s, k});
    std::sort(stamps.begin(), stamps.end());
    for (const auto& [time_s, pose] : session.estimate) {
      const auto next = std::upper_bound(stamps.begin(), stamps.end(),
                                         std::pair<double, size_t>{time_s + kRounded_s, before.size()});
      const size_t k = next == stamps.begin() ? stamps.front().second : std::prev(next)->second;
      path.push_back({time_s, after[k].T_map_robot * core::between(before[k].T_map_robot, pose)});
    }
  }
  std::stable_sort(path.begin(), path.end(),
                   [](const auto& a, const auto& b) { return a.time_s < b.time_s; });
  return path;
}

std::string mergeJson(const MergedMap& merged) {
  auto list = nlohmann::ordered_json::array();
  for (const auto& one : merged.sessions) {
    nlohmann::ordered_json entry{{"name", one.session.name},
                                 {"map", one.session.path},
                                 {"path", one.session.name + ".tum"},
                                 {"key_frames", one.key_frames}};
    if (!list.empty()) {
      const auto& T = one.place.T_map_part;
      entry["pose"] = {{"x_m", T.x}, {"y_m", T.y}, {"yaw_rad", T.phi}};
      entry["fitting_key_frames"] = one.place.fitting;
      entry["extent_m"] = one.place.extent_m;
      entry["ahead_nats"] = one.place.ahead_nats;
      entry["shared"] = one.place.shared;
      entry["contradicted"] = one.place.contradicted;
    }
    list.push_back(std::move(entry));
  }
  return nlohmann::ordered_json{{"sessions", std::move(list)}, {"loops", merged.loops}}.dump(2) + "\n";
}

int acceptedLoops(const mapping::MapBuilder& method) {
  const auto journal = mapping::journalOf(method);
  return static_cast<int>(std::count_if(journal.begin(), journal.end(), [](const core::JournalEntry& entry) {
    return entry.event == core::JournalEvent::kAccepted;
  }));
}

void describe(const MergedMap& merged, const files::IniFile& config, const std::string& folder,
              resources::Manifest& manifest) {
  for (const auto& one : merged.sessions) {
    manifest.inputs[one.session.simplemap] = resources::fileSha256(one.session.simplemap);
    manifest.files[one.session.name + ".tum"] = "its path in the merged map, TUM form: rasterslam eval, evo";
  }
  for (const auto& line : mapping::readMethodConfig(config).report)
    manifest.config[line.section + "." + line.info.key] = line.value;
  manifest.results["sessions"] = std::to_string(merged.sessions.size());
  results::describePose("end_final", merged.sessions.back().path.back().pose, manifest.results);
  for (const auto& [file, note] : results::fileNotes())
    if (fs::exists(folder + "/" + file)) manifest.files[file] = note;
  manifest.files["merge.json"] = "how the maps lie to one another, and what speaks for it";
}

}  // namespace

MergedMap mergeMaps(const std::vector<std::string>& maps, const files::IniFile& method_config,
                    const std::string& folder, bool overwrite, resources::Manifest manifest,
                    core::Progress& progress) {
  if (maps.size() < 2) throw core::InputError("merge: found 1 map, expected two or more");
  files::PendingFolder output(folder, overwrite);
  const JoinedSessions joined = joinSessions(maps, method_config, progress);
  MergedMap merged;
  for (size_t s = 0; s < maps.size(); ++s)
    merged.sessions.push_back({joined.sessions[s], joined.places[s],
                               static_cast<int>(joined.before[s].size()),
                               movedPath(joined.sessions[s], joined.before[s], joined.key_frames[s])});
  merged.loops = acceptedLoops(joined.method);
  for (const auto& one : merged.sessions)
    logs::writeTum(one.path, output.path() + "/" + one.session.name + ".tum");
  const auto map = mapping::currentMap(joined.method);
  mapping::saveMaps(joined.method, map, output.path());
  results::writeScene(joined.method, map, merged.sessions.back().path, joined.key_frames.back().back().scan,
                      output.path() + "/map.3Dscene");
  files::writeFileAtomically(output.path() + "/merge.json", mergeJson(merged));
  describe(merged, method_config, output.path(), manifest);
  resources::writeManifest(manifest, output.path() + "/manifest.json");
  output.commit();
  return merged;
}

}  // namespace slam::sessions
