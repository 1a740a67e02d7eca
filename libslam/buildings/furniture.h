#pragma once
#include <cstdint>

#include "libslam/world/plan.h"

namespace slam::buildings {

/// What counts as furniture, and where it may go.
struct FurnitureRules {
  double largest_m = 2.5;    ///< longest side of what counts as furniture
  double farthest_m = 1.5;   ///< a piece moves by at most so much along each axis of the plan
  double clearance_m = 0.3;  ///< radius of the robot whose ways stay open
};

/// A plan after somebody has moved furniture.
struct MovedFurniture {
  world::Plan plan;
  int pieces = 0, moved = 0;  ///< that could have been moved, and that were
};

/// Moves a share (0 to 1) of the furniture: whole cells, quarter turns, chance from (seed, "furniture"). The
/// same bytes on every machine.
///
/// Furniture is what a raster can know of it: an 8-connected piece of occupied cells that nothing connects to
/// other cells, neither at the plan's edge nor longer than largest_m; and not a thin line of a metre or more,
/// which will be a wall between two doorways. Pieces of at most 0.15 m that stand near each other are a
/// table's legs and go together. So what stands against a wall stays, and a free pillar may go. Materials
/// move
/// along. A piece goes only onto free cells, not within clearance_m of a doorway, and only where all that was
/// connected round about stays connected, both as free floor and as ways of a disc of clearance_m: nothing is
/// shut in, nor carried through a wall. A piece that finds no such place in 30 draws stays.
MovedFurniture moveFurniture(const world::Plan& plan, std::uint64_t seed, double share,
                             const FurnitureRules& rules = {});

}  // namespace slam::buildings
