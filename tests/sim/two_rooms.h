#pragma once
#include "libslam/world/plan.h"

namespace slam::sim {

/// Two rooms of 6 x 6 m at 5 cm, side by side, walls 10 cm thick; in the middle wall a doorway of 1 m at y =
/// 3 m, with a door.
inline world::Plan twoRooms() {
  world::Plan plan;
  plan.name = "two rooms";
  plan.columns = 242;
  plan.rows = 120;
  plan.cells.assign(size_t{242} * 120, world::Cell::kFree);
  for (int row = 0; row < plan.rows; ++row)
    for (int column = 0; column < plan.columns; ++column) {
      const bool is_outer = row < 2 || row >= 118 || column < 2 || column >= 240;
      const bool is_middle = (column == 120 || column == 121) && !(row >= 50 && row < 70);
      if (is_outer || is_middle)
        plan.cells[static_cast<size_t>(row) * 242 + static_cast<size_t>(column)] = world::Cell::kOccupied;
    }
  plan.doors = {{120, 50, 122, 70}};
  return plan;
}

}  // namespace slam::sim
