#pragma once
#include <vector>

#include "libslam/scanmatch/scan_points.h"
#include "libslam/scanmatch/surfel_map.h"
#include "tests/scanmatch/drawn_rooms.h"

namespace slam::scanmatch_test {

/// Of a scan at each pose.
inline scanmatch::SurfelMap mapOf(const std::vector<Wall>& walls, const std::vector<core::Pose2>& poses) {
  core::RandomStream chance(1, "map");
  scanmatch::SurfelMap map(0.1, 0.03);
  map.clear({}, 30);
  for (const auto& pose : poses) map.add(scanmatch::patchPoints(look(walls, pose, {}, chance), {}), pose);
  return map;
}

}  // namespace slam::scanmatch_test
