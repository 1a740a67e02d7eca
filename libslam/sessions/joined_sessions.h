#pragma once
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/core/progress.h"
#include "libslam/files/ini.h"
#include "libslam/loops/part_place.h"
#include "libslam/mapping/key_frames.h"
#include "libslam/mapping/map_builder.h"

namespace slam::sessions {

/// A map of before: the folder of a run or an exploration, or a .simplemap by itself.
struct Session {
  std::string path;           ///< as given
  std::string name;           ///< of the folder or file, unlike those of the others
  std::string simplemap;      ///< its key frames
  core::Trajectory estimate;  ///< as it was in the end; empty for a .simplemap
};

/// Whether this names a map of before, for commands that also take logs: a folder, or a .simplemap.
bool namesMap(const std::string& path);

/// The file that a session's map is in. Errors: InputError.
std::string simplemapOf(const std::string& path);

/// A map more of whose overlap with the others speaks against it than this is of another place, or has
/// changed beyond recognition. Right places reach 0.07 with a third of the furniture moved
/// (benchmarks/results/merging.txt); a hall of the same outline with other pillars had 0.16 in a trial.
inline constexpr double kMostContradicted = 0.15;

/// Sessions of one building in one map, in the frame of the first.
struct JoinedSessions {
  std::vector<Session> sessions;
  std::vector<loops::PartPlace> places;  ///< one each; that of the first is void
  std::vector<std::vector<mapping::KeyFrame>> before,
      key_frames;              ///< of each: as they were given, and as they lie in the end
  mapping::MapBuilder method;  ///< of type graph: holds the map of all
};
/// Finds maps in one another, as a method of type graph with this configuration does. Errors: InputError for
/// what holds no key frames, and for maps that hold the same scans; MethodError where a map has no proved
/// place in the others, or contradicts them there (kMostContradicted): the message says so, or that it is the
/// mirror image of one. What `progress` throws.
JoinedSessions joinSessions(const std::vector<std::string>& maps, const files::IniFile& method_config,
                            core::Progress& progress);

}  // namespace slam::sessions
