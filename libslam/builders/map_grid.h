#pragma once
#include <mrpt/maps/COccupancyGridMap2D.h>

#include <string>

#include "libslam/builders/mapping_options.h"

namespace mrpt::slam {
class CMetricMapBuilder;
}

namespace slam::builders {

/// The small empty grid that a builder of ours begins with: MRPT's, or ExactGrid, as [mapping] has it.
mrpt::maps::COccupancyGridMap2D::Ptr makeMapGrid(const MappingOptions& options);

/// The first occupancy grid of a builder's map. REQUIRES that it holds one (ContractError).
mrpt::maps::COccupancyGridMap2D::Ptr gridOf(const mrpt::slam::CMetricMapBuilder& builder);

/// "the map would hold 12 million cells, allowed are ..." for a MethodError.
std::string tooManyCells(double cells, double max_map_cells);

}  // namespace slam::builders
