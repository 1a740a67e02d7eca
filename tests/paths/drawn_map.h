#pragma once
#include <string>
#include <vector>

#include "libslam/gridmap/occupancy_raster.h"

namespace slam::paths {

/// A map drawn as text, the top line first: '#' occupied, '.' free, anything else unknown. Its lower left
/// corner is the origin.
inline gridmap::OccupancyRaster drawnMap(const std::vector<std::string>& lines, double resolution_m = 1) {
  gridmap::OccupancyRaster map;
  map.rows = static_cast<int>(lines.size());
  map.columns = static_cast<int>(lines.front().size());
  map.resolution_m = resolution_m;
  for (auto line = lines.rbegin(); line != lines.rend(); ++line)
    for (const char c : *line) map.occupancy.push_back(c == '#' ? 0.9F : c == '.' ? 0.1F : 0.5F);
  return map;
}

/// The same with every character drawn `times` x `times` cells large.
inline gridmap::OccupancyRaster enlarged(const std::vector<std::string>& lines, int times,
                                         double resolution_m) {
  std::vector<std::string> large;
  for (const auto& line : lines) {
    std::string wide;
    for (const char c : line) wide.append(static_cast<size_t>(times), c);
    large.insert(large.end(), static_cast<size_t>(times), wide);
  }
  return drawnMap(large, resolution_m);
}

}  // namespace slam::paths
