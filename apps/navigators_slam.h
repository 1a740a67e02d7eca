#pragma once
#include <string>

#include "apps/commands.h"

namespace slam::apps {

/// Where the pose of a robot comes from that drives to a goal: `given` where that is not empty; else the
/// lidar's own odometry, kNavigatorsSlam, or with a camera, whose narrow view is too little for that, SLAM.
inline std::string navigatorsSlam(const std::string& given, bool has_camera) {
  if (!given.empty()) return given;
  return has_camera ? kExplorersSlam : kNavigatorsSlam;
}
inline constexpr const char* kNavigatorsSlamMeaning =
    "where the pose comes from: a name of 'rasterslam list methods', or odometry for the wheels (default: "
    "naive_flow; with a camera graph)";

}  // namespace slam::apps
