#pragma once
#include <string>
#include <vector>

#include "libslam/files/parameters.h"

namespace slam::builders {

/// Section [mapping]. A type reads only the rows that it uses.
struct MappingOptions {
  double resolution_m;
  std::string grid;                                ///< stock | exact
  std::string draw;                                ///< dots | rays; naive only
  std::string draw_after;                          ///< every_scan | moves; naive only
  double insert_distance_m, insert_angle_rad;      ///< not graph
  double localize_distance_m, localize_angle_rad;  ///< icp and rbpf
  double max_insert_range_m;
  double occupied_certainty;
  bool no_return_is_free;
  double max_map_cells;
  MappingOptions();
};

/// Rows of the section, of which each type puts its table together: the grid that is drawn, all types; key
/// frames; when a scan is matched, MRPT's matchers; how `naive` draws.
using MappingRows = std::vector<files::ParameterTable<MappingOptions>::Row>;
MappingRows gridRows();
MappingRows keyFrameRows();
MappingRows matcherRows();
MappingRows drawingRows();
/// The table of these, in this order.
files::ParameterTable<MappingOptions> mappingTable(const std::vector<MappingRows>& rows);

}  // namespace slam::builders
