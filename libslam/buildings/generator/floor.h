#pragma once
#include <vector>

#include "libslam/buildings/generator/site.h"

namespace slam::buildings {

/// A row of rooms side by side with one wall to a corridor.
struct Row {
  Rect rect;
  Side front;     ///< where the corridor is
  int low, high;  ///< the corridor's extent along the front: every room must reach into it for its door
};

/// Land between two long corridors, south and north of it, and two cross corridors, west and east.
struct Block {
  Rect rect;
};

/// A storey cut into corridors, in a net with loops once it is large enough, and what lies between them.
struct Floor {
  std::vector<Rect> corridors;
  std::vector<Row> rows;
  std::vector<Block> blocks;
};

/// How a kind cuts its storey; cells.
struct FloorPlan {
  int depth, least_depth;       ///< of a row of rooms
  int least_block, most_block;  ///< length of a block along the long corridors
  int least_room;               ///< length of a row's shortest room
  int between;                  ///< between two rows back to back: a wall, or a court for daylight
};

/// Long corridors in x at the distance of two rows of rooms; two or more are joined by a corridor at each
/// end, and by cross corridors that are not aligned from block to block. A narrow site has one corridor, or
/// one with rooms on one side. Carves the corridors. Too small: InputError.
Floor layFloor(Site& site, const std::string& kind, const FloorPlan& plan);

/// A row's rooms: each reaches at least `least` along the corridor (REQUIRES that of the row), those at the
/// ends go on into the corners. {rect, low, high}: the room and where along the front its door may lie.
struct RowRoom {
  Rect rect;
  int low, high;
};
std::vector<RowRoom> cutRow(Site& site, const Row& row, int least, int most);

/// A block as two rows with a wall or a court between their backs, or as one row where it is too shallow for
/// two.
std::vector<Row> rowsOf(Site& site, const Rect& block, int least_depth, int between);

Side opposite(Side side);

}  // namespace slam::buildings
