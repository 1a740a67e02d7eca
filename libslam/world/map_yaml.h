#pragma once
#include <string>
#include <vector>

#include "libslam/world/plan.h"

namespace slam::world {

/// A ROS map_server description of a map picture.
struct MapYaml {
  std::string image_path;  ///< beside the yaml unless absolute
  PlanOptions options;
  std::string materials_path;  ///< as image_path; empty when the key is absent
  bool is_raw = false;         ///< mode raw: the pixel is the occupancy in percent, above 100 unknown
  std::vector<Door> doors;
  std::string doors_where;  ///< "map.yaml:8", for errors about doors that do not fit the picture
};

/// Reads a map yaml, one YAML document. Keys: image, resolution, origin (required), negate, occupied_thresh,
/// free_thresh, mode; and two of ours, which map_server passes over: materials, and doors, a list of [x0, y0,
/// x1, y1], world::Door's cells. Errors (InputError with file, line and key): missing file, what is no YAML,
/// unknown key (with the nearest known one), missing or duplicate key, malformed value, nan, out of range.
MapYaml readMapYaml(const std::string& path);

/// The text that readMapYaml reads back to the same; names relative to the yaml, no key for an empty
/// `materials_name` or for no doors.
std::string formatMapYaml(const std::string& image_name, const PlanOptions& options,
                          const std::string& materials_name = "", const std::vector<Door>& doors = {});

/// InputError naming `where` for a resolution, placement or threshold that no plan can have.
void requireSensible(const PlanOptions& options, const std::string& where);

}  // namespace slam::world
