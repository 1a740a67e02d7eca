#include "libslam/run/earlier_map.h"

#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"
#include "libslam/logs/log_reader.h"
#include "libslam/resources/file_hash.h"
#include "libslam/results/manifest_entries.h"
#include "libslam/run/known_map.h"
#include "libslam/world/plan.h"

namespace slam::run {
namespace {

double lidarReach(const std::string& log_path) {
  const auto first = logs::LogReader(log_path).next();
  if (!first) throw core::InputError(log_path + ": holds 0 laser scans, expected at least 1");
  return first->scan.max_range_m;
}

/// The map as key frames: the file itself, that of a folder, or views drawn in a grid, which go into the
/// output.
std::string keyFramesOf(const Continuation& continuation, const std::string& log_path,
                        const std::string& output) {
  const std::string& map = continuation.folder;
  if (isGridMap(map)) {
    std::string views = output + "/map.simplemap";
    mapping::writeKeyFrames(viewsOf(loadGridMap(map), lidarReach(log_path), map), views);
    return views;
  }
  if (std::filesystem::path(map).extension() == ".simplemap") return map;
  if (std::filesystem::is_regular_file(map))
    throw core::InputError(map +
                           ": found a file of another kind, expected the folder of a run, a ROS map's .yaml, "
                           ".gridmap.gz or .simplemap");
  return map + "/map.simplemap";
}

}  // namespace

core::Pose2 endOfRun(const std::string& folder) {
  const std::string path = folder + "/manifest.json";
  const auto manifest = resources::readManifest(path);
  const auto number = [&](const std::string& key) {
    double value = 0;
    const auto it = manifest.results.find("end_final." + key);
    if (it == manifest.results.end() || !files::parseNumber(it->second, value))
      throw core::InputError(path + ": key 'results.end_final." + key +
                             "' is missing, expected the folder of a 'rasterslam run'");
    return value;
  };
  return {number("x_m"), number("y_m"), number("yaw_rad")};
}

void beginInMap(mapping::MapBuilder& method, const Continuation& continuation, const std::string& log_path,
                const std::string& output, resources::Manifest& manifest) {
  const std::string key_frames = keyFramesOf(continuation, log_path, output);
  const std::string& map = isGridMap(continuation.folder) ? continuation.folder : key_frames;
  std::optional<core::Pose2> T_map_robot = continuation.T_map_robot;
  const bool anywhere = continuation.localise_only && mapping::methodType(method.type).finds_itself;
  const bool is_run = map == continuation.folder + "/map.simplemap";
  if (!T_map_robot && !anywhere && is_run) T_map_robot = endOfRun(continuation.folder);
  mapping::continueMap(method, key_frames, T_map_robot, continuation.localise_only);
  manifest.inputs[map] = resources::fileSha256(map);
  manifest.results[continuation.localise_only ? "localised_in" : "continues"] = continuation.folder;
  if (T_map_robot) results::describePose("start", *T_map_robot, manifest.results);
}

void keepMap(const std::string& map, const std::string& to) {
  const auto copy = [&](const std::string& file, const std::string& name) {
    if (std::filesystem::exists(file)) files::writeFileAtomically(to + "/" + name, files::readTextFile(file));
  };
  const std::filesystem::path path(map);
  if (isGridMap(map)) {
    if (path.extension() == ".gz" || path.extension() == ".gridmap")
      world::saveCellMap(loadGridMap(map), to + "/map.yaml");
    else
      world::savePlan(world::loadPlan(map), to + "/map.yaml");  // it may be one, with materials and doors
    if (path.extension() == ".gz") copy(map, "map.gridmap.gz");
    return;
  }
  const std::string from = path.extension() == ".simplemap" ? path.parent_path().string() : map;
  for (const char* file : {"map.yaml", "map.png", "map.gridmap.gz", "graph.g2o"})
    copy(from + "/" + file, file);
  copy(path.extension() == ".simplemap" ? map : from + "/map.simplemap", "map.simplemap");
}

}  // namespace slam::run
