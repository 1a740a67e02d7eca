#pragma once
#include <cstddef>
#include <vector>

namespace slam::world {

/// Marked cells begin .. end-1 (indices into the raster) of one row, with an unmarked cell or the edge at
/// both ends.
struct RegionRun {
  size_t begin, end;
  size_t region;  ///< the first run of the 4-connected region to which it belongs
};

/// The marked cells of a row-major raster as runs, in ascending order. Linear in the cells; a union-find over
/// the runs (He, Chao and Suzuki, IEEE Trans. Image Processing 17(5), 2008), small beside the raster.
std::vector<RegionRun> regionRuns(int columns, const std::vector<char>& marked);

/// The `region` of the runs of the largest set, counted in cells; of equals the one with the smallest index.
/// REQUIRES a run.
size_t largestRegionOf(const std::vector<RegionRun>& runs);

/// The largest 4-connected set of marked cells of a row-major raster, as ascending indices; of equals the one
/// with the smallest index. Empty when nothing is marked. Linear in the cells.
std::vector<size_t> largestRegion(int columns, const std::vector<char>& marked);

}  // namespace slam::world
