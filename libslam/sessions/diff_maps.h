#pragma once
#include <string>

#include "libslam/core/progress.h"
#include "libslam/files/ini.h"
#include "libslam/resources/manifest.h"
#include "libslam/sessions/map_changes.h"
#include "libslam/table/table.h"
#include "libslam/world/cell_map.h"

namespace slam::sessions {

/// Two maps of one place, in the frame of the first.
struct MapPair {
  world::CellMap before, after;
  std::string before_name, after_name;
};

/// Brings two maps together to be compared. Both grids (world: ROS map yaml, .gridmap.gz): they are of one
/// frame. Else maps of sessions (merge_maps.h): the second is found in the first as mergeMaps() does, both
/// are refined together, and each is drawn from its own scans alone. Errors: as mergeMaps(); InputError for a
/// grid beside a session.
MapPair bringTogether(const std::string& before, const std::string& after,
                      const files::IniFile& method_config, core::Progress& progress);

/// A row per change, numbered as in the picture.
table::Table changeTable(const MapPair& maps, const MapChanges& changes);

/// What has changed from one map to a later one; writes a folder:
///   changes.txt   changes.csv   changes.json   changes.png   changes.html   manifest.json
/// The folder appears whole or not at all. Same maps, same bytes. Errors: as bringTogether().
MapChanges diffMaps(const std::string& before, const std::string& after, const files::IniFile& method_config,
                    const std::string& folder, bool overwrite, resources::Manifest manifest,
                    core::Progress& progress);

}  // namespace slam::sessions
