#include "libslam/world/region.h"

#include <algorithm>

namespace slam::world {

std::vector<size_t> largestRegion(int columns_of_raster, std::vector<char> marked) {
  const auto columns = static_cast<size_t>(columns_of_raster);
  std::vector<size_t> largest, region;
  for (size_t seed = 0; seed < marked.size(); ++seed) {
    if (!marked[seed]) continue;
    region.assign(1, seed);
    marked[seed] = 0;
    const auto add = [&](bool exists, size_t index) {
      if (!exists || !marked[index]) return;
      marked[index] = 0;
      region.push_back(index);
    };
    for (size_t done = 0; done < region.size(); ++done) {
      const size_t index = region[done];
      add(index % columns > 0, index - 1);
      add(index % columns + 1 < columns, index + 1);
      add(index >= columns, index - columns);
      add(index + columns < marked.size(), index + columns);
    }
    if (region.size() > largest.size()) largest.swap(region);
  }
  std::sort(largest.begin(), largest.end());
  return largest;
}

}  // namespace slam::world
