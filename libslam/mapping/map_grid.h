#pragma once
#include <mrpt/maps/COccupancyGridMap2D.h>

#include <string>

#include "libslam/mapping/method_config.h"

namespace slam::mapping {

/// The small empty grid that a builder of ours begins with: MRPT's, or ExactGrid, as [mapping] has it.
mrpt::maps::COccupancyGridMap2D::Ptr makeMapGrid(const MappingOptions& options);

/// "the map would hold 12 million cells, allowed are ..." for a MethodError.
std::string tooManyCells(double cells, double max_map_cells);

}  // namespace slam::mapping
