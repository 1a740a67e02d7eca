#pragma once
#include <string>
#include <utility>
#include <vector>

#include "libslam/core/random.h"
#include "libslam/world/plan.h"

namespace slam::buildings {

/// Cells x0 .. x1-1 by y0 .. y1-1. All drawing is in whole cells, y up.
struct Rect {
  int x0, y0, x1, y1;
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  bool overlaps(const Rect& other) const {
    return x0 < other.x1 && other.x0 < x1 && y0 < other.y1 && other.y0 < y1;
  }
};

enum class Side { kWest, kEast, kSouth, kNorth };

/// How a piece of furniture looks at the height of a lidar.
enum class Shape {
  kSolid,  ///< a cupboard, a bed
  kLegs,   ///< a table: four legs of 10 cm in the corners
  kDisc,   ///< a plant, a chair's foot
  kDesk    ///< drawers, a chair, a panel; at most 1.4 x 0.7 m, else a robot would fit in beside the chair
};

/// What a canvas is made of; by default what the committed worlds are.
struct CanvasScale {
  double resolution_m = 0.05;
  int rim = 16;      ///< cells around the rooms, for walls and a margin of unknown
  int passage = 12;  ///< free way beside furniture, cells: a robot of 0.2 m radius passes with room to spare

  /// A length in whole cells, the nearest number of them and at least one. Integer arithmetic.
  int cells(int length_cm) const;
};

/// Draws a building: first carve() all free space, then raiseWalls(), then furnish. What is not carved and
/// not near free space stays unknown.
class Canvas {
 public:
  /// The rim is added all round: rooms may use 0 .. width by 0 .. height and niches a few cells more.
  Canvas(int width, int height, const CanvasScale& scale = {});

  void carve(const Rect& rect);
  /// Carves a doorway, which becomes one of Plan::doors.
  void carveDoor(const Rect& rect);
  /// Every cell that is not free and within `thickness` cells of a free one becomes a wall, so the building
  /// is enclosed whatever was carved.
  void raiseWalls(int thickness);
  /// Hollows a raised wall out where free space lies before it, as windows do; furniture keeps its wall.
  /// REQUIRES depth + 2 <= the wall's thickness, so that a wall remains.
  void recess(const Rect& room, Side wall, int along, int length, int depth);
  /// Whole rectangle or disc, whatever it covers: for pillars and the like.
  void fill(const Rect& rect);
  void fillDisc(const Rect& bounds);

  /// No piece is placed on these, until others are given: the ways through doors.
  void keepFree(std::vector<Rect> places) { kept_free_ = std::move(places); }
  /// True where a piece leaves every way open and what is to be kept free: each of its sides is either flush
  /// with something solid all along, or has a passage of free cells before it; not both of two opposite sides
  /// are flush.
  bool leavesWaysOpen(const Rect& piece) const;
  /// Draws a piece where it leaves every way open; else returns false and draws nothing.
  bool place(const Rect& piece, Shape shape = Shape::kSolid, Side back = Side::kSouth);
  /// The same, flush with a wall of the room, `along` cells from its west or south end.
  bool placeAt(const Rect& room, Side wall, int along, int length, int depth, Shape shape = Shape::kSolid);
  /// The same at a random place along that wall; gives up after some tries.
  bool placeAlong(core::RandomStream& random, const Rect& room, Side wall, int length, int depth,
                  Shape shape = Shape::kSolid);
  /// Anywhere in the room, free all round.
  bool placeInside(core::RandomStream& random, const Rect& room, int width, int height, Shape shape);

  /// What is occupied in the rectangle becomes this material.
  void makeOf(world::Material material, const Rect& rect);

  /// The drawing, in which free pockets that nothing can enter (behind a plant in a corner) are filled.
  world::Plan plan(const std::string& name) const;

  const CanvasScale& scale() const { return scale_; }
  std::vector<Rect> doors() const;

 private:
  size_t index(int x, int y) const {
    return static_cast<size_t>(y + scale_.rim) * plan_.columns + (x + scale_.rim);
  }
  world::Cell& at(int x, int y) { return plan_.cells[index(x, y)]; }
  world::Cell at(int x, int y) const { return plan_.cells[index(x, y)]; }
  bool isFree(int x, int y) const {
    return plan_.contains(x + scale_.rim, y + scale_.rim) && at(x, y) == world::Cell::kFree;
  }
  bool allFree(const Rect& rect) const;
  bool noneFree(const Rect& rect) const;
  void draw(const Rect& piece, Shape shape, Side back);

  CanvasScale scale_;
  world::Plan plan_;
  std::vector<Rect> kept_free_;
};

/// A whole number from low to high, both included.
int pick(core::RandomStream& random, int low, int high);
Side pickSide(core::RandomStream& random);

/// Cuts `total` cells into rooms with walls of `wall` cells between; [begin, end) of each. Every room has at
/// least `least` cells, and at most `most` or what cannot be cut once more. REQUIRES total >= least.
std::vector<std::pair<int, int>> partition(core::RandomStream& random, int total, int least, int most,
                                           int wall);

}  // namespace slam::buildings
