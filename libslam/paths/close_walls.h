#pragma once
#include <cstddef>
#include <vector>

#include "libslam/paths/free_space.h"

namespace slam::paths {

/// Walls go on: the unknown cells beside free ones that lie between two occupied cells at most gap_m apart
/// (centre to centre, in one of 16 directions, nothing free in between) become occupied. Beams that meet a
/// wall far away or at a flat angle leave gaps in it that no room is behind. What is narrower than the
/// shortest frontier that counts is no loss. gap_m of less than two cells closes nothing. Cost: that of
/// frontierCells(), and up to 16 rays of gap_m per unknown cell beside one.
void closeWalls(FreeSpace& space, double gap_m);
/// The same where the frontier cells are known, all of them. Answers with the cells that became occupied.
std::vector<std::size_t> closeWalls(FreeSpace& space, const std::vector<std::size_t>& frontier_cells,
                                    double gap_m);

}  // namespace slam::paths
