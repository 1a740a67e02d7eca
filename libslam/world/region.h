#pragma once
#include <cstddef>
#include <vector>

namespace slam::world {

/// The largest 4-connected set of marked cells of a row-major raster, as ascending indices; of equals the one
/// with the smallest index. Empty when nothing is marked. Linear in the cells.
std::vector<size_t> largestRegion(int columns, std::vector<char> marked);

}  // namespace slam::world
