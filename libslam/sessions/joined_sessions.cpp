#include "libslam/sessions/joined_sessions.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <string_view>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"
#include "libslam/graph/graph_slam.h"
#include "libslam/logs/trajectory_io.h"

namespace slam::sessions {
namespace {

namespace fs = std::filesystem;
using core::Pose2;
using mapping::KeyFrame;

/// Two maps that share more of their scans than this are one.
constexpr double kSameScans = 0.5;
/// A mirror image is called one only where it fits beyond doubt: many buildings are nearly their own.
constexpr double kMirrorContradicted = 0.03, kMirrorShared = 0.5;

core::Trajectory pathOf(const std::string& path) {
  for (const char* file : {"/trajectory_final.tum", "/trajectory.tum"})
    if (fs::exists(path + file)) return logs::readTum(path + file);
  return {};
}

/// The share of the second map's scans that are scans of the first, beam by beam.
double sharedScans(const std::vector<KeyFrame>& first, const std::vector<KeyFrame>& second) {
  const auto bytesOf = [](const KeyFrame& frame) {
    const auto& ranges = frame.scan.ranges_m;
    return std::string_view(reinterpret_cast<const char*>(ranges.data()), ranges.size() * sizeof(float));
  };
  std::set<std::string_view> known;
  for (const auto& frame : first) known.insert(bytesOf(frame));
  const auto same = std::count_if(second.begin(), second.end(),
                                  [&](const KeyFrame& frame) { return known.count(bytesOf(frame)) > 0; });
  return static_cast<double>(same) / static_cast<double>(second.size());
}

void refuseSameScans(const std::vector<Session>& sessions, const std::vector<std::vector<KeyFrame>>& maps) {
  for (size_t b = 1; b < maps.size(); ++b)
    for (size_t a = 0; a < b; ++a)
      if (sharedScans(maps[a], maps[b]) > kSameScans)
        throw core::InputError(sessions[b].path + ": holds the same scans as " + sessions[a].path +
                               ", expected maps of different drives");
}

/// What a lidar that hangs upside down would make of it.
KeyFrame mirrored(KeyFrame frame) {
  const auto mirror = [](const Pose2& pose) { return Pose2{pose.x, -pose.y, -pose.phi}; };
  lidar::Scan& scan = frame.scan;
  std::reverse(scan.ranges_m.begin(), scan.ranges_m.end());
  scan.first_angle_rad =
      -(scan.first_angle_rad + scan.step_rad * static_cast<double>(scan.ranges_m.size() - 1));
  scan.T_robot_lidar = mirror(scan.T_robot_lidar);
  frame.T_map_robot = mirror(frame.T_map_robot);
  return frame;
}

bool belongs(const loops::PartPlace& place) {
  return place.is_joined && place.contradicted <= kMostContradicted;
}

std::string percent(double share) {
  return files::formatNumber(std::round(1000 * share) / 10) + " %";
}

/// Why a map is refused; for those that are mirrored a second search tells.
std::string refusal(const Session& session, const loops::PartPlace& place,
                    const std::vector<KeyFrame>& key_frames, const std::string& first,
                    const files::IniFile& config, core::Progress& progress) {
  if (place.is_joined)
    return session.path + ": found " + percent(place.contradicted) +
           " of what it shares with the other maps to contradict them, expected at most " +
           percent(kMostContradicted) + ": is it of another place?";
  progress.begin("looking whether it is a mirror image");
  std::vector<KeyFrame> image;
  image.reserve(key_frames.size());
  for (const auto& frame : key_frames) image.push_back(mirrored(frame));
  const files::ScratchFolder scratch;
  mapping::writeKeyFrames(image, scratch / "mirrored.simplemap");
  auto method = mapping::makeMapBuilder(config, "graph", 1);
  const auto mirror = mapping::joinMaps(method, {first, scratch / "mirrored.simplemap"}, progress);
  progress.end();
  if (mirror.at(0).is_joined && mirror.at(0).contradicted <= kMirrorContradicted &&
      mirror.at(0).shared >= kMirrorShared)
    return session.path + ": is a mirror image of the first map: does its lidar hang upside down?";
  return session.path + ": no place in the other maps is proved to be its own";
}

/// The sessions that `maps` name.
std::vector<Session> findSessions(const std::vector<std::string>& maps) {
  std::vector<Session> sessions;
  std::set<std::string> names;
  for (const auto& path : maps) {
    Session session{path, "", simplemapOf(path), fs::is_directory(path) ? pathOf(path) : core::Trajectory{}};
    // A path that ends with a slash names the folder, too; of a folder's name a dot is a part.
    const fs::path own = fs::absolute(path + "/.").lexically_normal().parent_path();
    const std::string name = (fs::is_directory(path) ? own.filename() : own.stem()).string();
    session.name = name;
    for (int n = 2; !names.insert(session.name).second; ++n) session.name = name + "_" + std::to_string(n);
    sessions.push_back(std::move(session));
  }
  return sessions;
}

}  // namespace

std::string simplemapOf(const std::string& path) {
  if (fs::path(path).extension() == ".simplemap") return path;
  std::string file = path + "/map.simplemap";
  if (!fs::is_directory(path) || !fs::exists(file))
    throw core::InputError(path + ": holds no map.simplemap, expected the folder of a run or a .simplemap");
  return file;
}

bool namesMap(const std::string& path) {
  return fs::is_directory(path) || fs::path(path).extension() == ".simplemap";
}

JoinedSessions joinSessions(const std::vector<std::string>& maps, const files::IniFile& method_config,
                            core::Progress& progress) {
  JoinedSessions joined;
  joined.sessions = findSessions(maps);
  std::vector<std::string> files;
  for (const auto& session : joined.sessions) {
    joined.before.push_back(mapping::readKeyFrames(session.simplemap));
    files.push_back(session.simplemap);
  }
  refuseSameScans(joined.sessions, joined.before);
  joined.method = mapping::makeMapBuilder(method_config, "graph", 1);
  progress.begin("looking for the maps in one another");
  joined.places = mapping::joinMaps(joined.method, files, progress);
  progress.end();
  joined.places.insert(joined.places.begin(), loops::PartPlace{});
  for (size_t s = 1; s < maps.size(); ++s)
    if (!belongs(joined.places[s]))
      throw core::MethodError(
          refusal(joined.sessions[s], joined.places[s], joined.before[s], files[0], method_config, progress));
  int next = 0;
  joined.key_frames = joined.before;
  for (auto& session : joined.key_frames)
    for (auto& frame : session) frame.T_map_robot = mapping::graphSlamOf(joined.method)->keyframePose(next++);
  return joined;
}

}  // namespace slam::sessions
