#pragma once
#include <string>

#include "libslam/core/pose2.h"
#include "libslam/lidar/scan.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/world/plan.h"

namespace slam::results {

/// Writes what a method knows in the end as a .3Dscene of MRPT's stock classes, map frame, seen from above:
/// the layers map, path, scan (`last_scan`) and robot, and where the method has them particles, graph and
/// loops (viewer/layers.h has their names and looks). `map`: mapping::currentMap(); `path`: as the method has
/// it in the end, in the order of the log. Same input, same bytes. Errors: core::IoError.
void writeScene(const mapping::MapBuilder& method, const gridmap::OccupancyRaster& map,
                const core::Trajectory& path, const lidar::Scan& last_scan, const std::string& file);

/// Puts the true path, and the plan where it is known, under the layers of such a file, in place of those
/// that it has. Errors: InputError where the file is no scene; core::IoError.
void addTruthToScene(const core::Trajectory& truth, const world::Plan* plan, const core::Pose2& T_map_world,
                     const std::string& file);

}  // namespace slam::results
