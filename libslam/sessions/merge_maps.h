#pragma once
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/core/progress.h"
#include "libslam/files/ini.h"
#include "libslam/resources/manifest.h"
#include "libslam/sessions/joined_sessions.h"

namespace slam::sessions {

struct MergedSession {
  Session session;
  loops::PartPlace place;  ///< in the frame of the first, of which it is void
  int key_frames = 0;
  core::Trajectory path;  ///< of its scans in the merged map; without a path, of its key frames
};
struct MergedMap {
  std::vector<MergedSession> sessions;
  int loops = 0;  ///< that were accepted in the end, within maps and between them
};

/// Makes one map of several of the same building, by other robots or of other days, of which nobody knows how
/// they lie to one another, with a method of type graph (`method_config`), in the frame of the first. Writes
/// a folder:
///   map.yaml + map.png   map.gridmap.gz   map.simplemap   graph.g2o   map.3Dscene   manifest.json
///   NAME.tum      of each session: the path of its scans in the merged map (of its key frames, where only
///                 those are known)
///   merge.json    how each lies in the first, and what speaks for it
/// `run --localise` and `--continue` take that folder like a run's. Same maps, same bytes. The lidars may
/// differ. The folder appears whole or not at all.
/// Errors: InputError for what holds no key frames, and for maps that hold the same scans; MethodError, and
/// nothing is written, where a map has no proved place in the others, or contradicts them there
/// (kMostContradicted): the message says so, or that it is the mirror image of one. core::Interrupted.
MergedMap mergeMaps(const std::vector<std::string>& maps, const files::IniFile& method_config,
                    const std::string& folder, bool overwrite, resources::Manifest manifest,
                    core::Progress& progress);

}  // namespace slam::sessions
