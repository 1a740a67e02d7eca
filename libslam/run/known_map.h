#pragma once
#include <string>
#include <vector>

#include "libslam/mapping/key_frames.h"
#include "libslam/world/cell_map.h"

namespace slam::run {

/// A map that a robot is to be found in, and that is a grid: a ROS map yaml with its picture, or an MRPT
/// occupancy grid (.gridmap.gz, .gridmap). By its name.
bool isGridMap(const std::string& path);

/// Reads one. Frame: the map's own, which is ROS's with the yaml's origin. Errors: InputError for a file that
/// is none, or without a wall or a free cell.
world::CellMap loadGridMap(const std::string& path);

/// What a lidar that looks all round (one beam a degree) sees from places all over the free space, for
/// methods whose map is made of scans. Places are 1.5 m apart, in open space farther, up to 8 m; those that
/// see hardly a wall are left out. Headings are 0. What lies behind unknown cells is not seen. Map frame;
/// same map, same views. Errors: InputError when no place sees walls within max_range_m. `name`: of the map,
/// for errors.
std::vector<mapping::KeyFrame> viewsOf(const world::CellMap& map, double max_range_m,
                                       const std::string& name);

}  // namespace slam::run
