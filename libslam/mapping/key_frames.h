#pragma once
#include <string>
#include <vector>

#include "libslam/gridmap/occupancy_raster.h"
#include "libslam/lidar/scan.h"

namespace slam::mapping {

/// A scan and where it is seen from.
struct KeyFrame {
  lidar::Scan scan;
  core::Pose2 T_map_robot;
};

/// Writes them as an MRPT simplemap, which continueMap() reads. Same key frames, same bytes. Errors: IoError.
void writeKeyFrames(const std::vector<KeyFrame>& key_frames, const std::string& path);

/// The scans of an MRPT simplemap at their mean poses, the first of each frame; frames without one are passed
/// over. Errors: InputError for a file that is none or holds no scan.
std::vector<KeyFrame> readKeyFrames(const std::string& path);

/// An MRPT occupancy grid, as saveMaps() or MRPT's programs write it. Errors: InputError for a file that is
/// none.
gridmap::OccupancyRaster readGridMap(const std::string& path);

}  // namespace slam::mapping
