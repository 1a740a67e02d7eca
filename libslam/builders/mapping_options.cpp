#include "libslam/builders/mapping_options.h"

#include <utility>

namespace slam::builders {

MappingRows gridRows() {
  return {{"resolution_m", &MappingOptions::resolution_m, 0.05, 0.005, 1.0, "side of a grid cell"},
          {"grid",
           &MappingOptions::grid,
           "stock",
           {"stock", "exact"},
           "MRPT's grid as it is, or with its insertion errors removed"},
          {"max_insert_range_m", &MappingOptions::max_insert_range_m, 35.0, 0.1, 1000.0,
           "rays change the grid up to this distance"},
          {"occupied_certainty", &MappingOptions::occupied_certainty, 0.65, 0.5, 0.999,
           "probability that one ray gives to a cell: occupied where it ends, free before"},
          {"no_return_is_free", &MappingOptions::no_return_is_free, true,
           "rays without return free cells: as far as the lidar sees (exact), half of max_insert_range_m "
           "(stock, and lost readings too)"},
          {"max_map_cells", &MappingOptions::max_map_cells, 1.28e8, 1e4, 1e11,
           "the method has failed when its grids, over all particles, would hold more cells"}};
}

MappingRows keyFrameRows() {
  return {{"insert_distance_m", &MappingOptions::insert_distance_m, 0.5, 0.0, 100.0,
           "travel after which a scan becomes a key frame"},
          {"insert_angle_deg", &MappingOptions::insert_angle_rad, 20.0, 0.0, 360.0,
           "turn after which a scan becomes a key frame"}};
}

MappingRows matcherRows() {
  return {{"localize_distance_m", &MappingOptions::localize_distance_m, 0.1, 0.0, 100.0,
           "travel after which a scan is matched to the map; dead reckoning before"},
          {"localize_angle_deg", &MappingOptions::localize_angle_rad, 2.0, 0.0, 360.0,
           "turn after which a scan is matched to the map"}};
}

MappingRows drawingRows() {
  return {{"draw",
           &MappingOptions::draw,
           "dots",
           {"dots", "rays"},
           "a dot for every return, or occupancy along whole rays"},
          {"draw_after",
           &MappingOptions::draw_after,
           "every_scan",
           {"every_scan", "moves"},
           "moves: scans after a turn in place or at rest are not drawn, nor is the first, as the original "
           "robot has it"}};
}

files::ParameterTable<MappingOptions> mappingTable(const std::vector<MappingRows>& rows) {
  MappingRows all;
  for (const auto& some : rows) all.insert(all.end(), some.begin(), some.end());
  return {"mapping", std::move(all)};
}

MappingOptions::MappingOptions() {
  static const auto kAll = mappingTable({gridRows(), keyFrameRows(), matcherRows(), drawingRows()});
  kAll.setDefaults(*this);
}

}  // namespace slam::builders
