#pragma once
#include <optional>
#include <string>

#include "libslam/core/pose2.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/resources/manifest.h"

namespace slam::run {

/// An earlier run whose map is gone on with.
struct Continuation {
  std::string folder;  ///< that buildMap() wrote, a .simplemap, or a grid map (isGridMap()); "" begins a map
  bool localise_only = false;  ///< its map stays: the folder gets the same map files, and a path
  std::optional<core::Pose2>
      T_map_robot;  ///< at the first scan, in the frame of that map; none: where that run ended, and with
                    ///< localise_only anywhere, where the method is of type graph
};

/// T_map_robot at the last scan of a run, as it is in the end. Errors: InputError.
core::Pose2 endOfRun(const std::string& folder);

/// Puts the earlier run's map into a new method, and says so in the manifest; a grid map's views go into the
/// folder `output`. REQUIRES a continuation with a folder. Errors: InputError.
void beginInMap(mapping::MapBuilder& method, const Continuation& continuation, const std::string& log_path,
                const std::string& output, resources::Manifest& manifest);

/// The map of before, byte for byte where it has these files: localising has not changed it.
void keepMap(const std::string& map, const std::string& to);

}  // namespace slam::run
