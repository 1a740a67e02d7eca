#pragma once
#include <vector>

#include "libslam/world/cell_map.h"

namespace slam::world {

/// Which cells (row-major, 1 or 0) are free and have room for a disc of `radius` cells around their centre:
/// it touches no occupied square (equality counts as touching) and stays within the map. Unknown cells are
/// no obstacle. The same answer as discCollides() at every cell's centre. REQUIRES radius >= 0. Cost: a pass
/// over the cells per column of the disc.
std::vector<char> admissibleCells(const CellMap& map, double radius);

/// The other way round: the cells whose square a disc of `radius` cells around the centre of a marked cell
/// touches.
std::vector<char> cellsUnderDiscs(int columns, const std::vector<char>& marked, double radius);

}  // namespace slam::world
