#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "libslam/world/plan.h"

namespace slam::oracle {

/// A square of cells of a plan, from (column, row) on; it may reach over the plan's edge.
struct Block {
  int column = 0, row = 0, side = 1;
};

/// Calls visit(index of Plan::cells) for every cell that is not occupied and holds a point from which some
/// point of the block is seen past the occupied squares, and maybe for some more; the block's own cells
/// first. Occupied cells of its rim stop no sight. Ends when `visit` answers false; many cells are visited
/// more than once. What is farther than range_cells (between the nearest points of both) is not seen; <= 0:
/// no limit.
///
/// From each cell of the block's rim, the sets of all straight lines are narrowed cell by cell along the
/// diagonals of each quadrant: Duerig's precise permissive field of view (2008), which by its construction
/// leaves no line of sight out. That is what a bound needs; sampled rays would miss slits. Cost: the cells
/// seen and those beside them.
void visitSeeing(const world::Plan& plan, const Block& block, double range_cells,
                 const std::function<bool(std::size_t)>& visit);

}  // namespace slam::oracle
