#pragma once
#include <string>

#include "libslam/core/pose2.h"

namespace slam::files {

/// What ROS's map_server wants to know of a map's picture.
struct RosMap {
  std::string image;  ///< relative to the yaml
  double resolution_m = 0.05;
  core::Pose2 T_map_image;  ///< the lower left corner of the picture
  bool negate = false;
  double occupied_threshold = 0.65, free_threshold = 0.196;
};

/// The pixels that map_server itself writes for cells that are occupied, unknown and free.
inline constexpr unsigned char kRosOccupied = 0, kRosUnknown = 205, kRosFree = 254;

/// The lines of a map's yaml; names are quoted where YAML needs it.
std::string rosMapYaml(const RosMap& map);
/// A text as a YAML value on one line.
std::string yamlScalar(const std::string& text);

}  // namespace slam::files
