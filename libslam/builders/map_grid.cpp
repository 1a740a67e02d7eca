#include "libslam/builders/map_grid.h"

#include <mrpt/slam/CMetricMapBuilder.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "libslam/builders/exact_grid.h"
#include "libslam/builders/mrpt_compat.h"
#include "libslam/core/error.h"
#include "libslam/files/parameters.h"

namespace slam::builders {

mrpt::maps::COccupancyGridMap2D::Ptr makeMapGrid(const MappingOptions& options) {
  const auto side_m = static_cast<float>(std::max(1.0, 4 * options.resolution_m));
  const auto resolution_m = static_cast<float>(options.resolution_m);
  mrpt::maps::COccupancyGridMap2D::Ptr grid;
  if (options.grid == "exact")
    grid = std::make_shared<ExactGrid>(-side_m, side_m, -side_m, side_m, resolution_m);
  else
    grid = mrpt::maps::COccupancyGridMap2D::Create(-side_m, side_m, -side_m, side_m, resolution_m);
  auto& insertion = grid->insertionOptions;
  insertion.maxDistanceInsertion = static_cast<float>(options.max_insert_range_m);
  insertion.maxOccupancyUpdateCertainty = static_cast<float>(options.occupied_certainty);
  insertion.considerInvalidRangesAsFreeSpace = options.no_return_is_free;
  return grid;
}

mrpt::maps::COccupancyGridMap2D::Ptr gridOf(const mrpt::slam::CMetricMapBuilder& builder) {
  auto grid =
      compat::asReference(builder.getCurrentlyBuiltMetricMap()).mapByClass<mrpt::maps::COccupancyGridMap2D>();
  if (!grid) throw core::ContractError("the method's map holds no grid");
  return grid;
}

std::string tooManyCells(double cells, double max_map_cells) {
  return "the map would hold " + files::formatNumber(std::round(cells / 1e6)) +
         " million cells, allowed are " + files::formatNumber(std::round(max_map_cells / 1e5) / 10) +
         " million ([mapping] max_map_cells); the method has diverged or the place is too large";
}

}  // namespace slam::builders
