#include <vector>

#include "libslam/buildings/drawn/buildings.h"
#include "libslam/buildings/drawn/canvas.h"

namespace slam::buildings {
namespace {

constexpr int kSide = 11, kPassageWidth = 26, kWall = 3, kPitch = kPassageWidth + kWall;

Rect cellRect(int column, int row) {
  return {column * kPitch, row * kPitch, column * kPitch + kPassageWidth, row * kPitch + kPassageWidth};
}

/// Opens the wall between a cell and its neighbour to the east or to the north.
void open(Canvas& canvas, int column, int row, bool to_east) {
  Rect gap = cellRect(column, row);
  if (to_east)
    gap.x0 = gap.x1, gap.x1 += kWall;
  else
    gap.y0 = gap.y1, gap.y1 += kWall;
  canvas.carve(gap);
}

void openBetween(Canvas& canvas, int column, int row, int dx, int dy) {
  open(canvas, dx < 0 ? column - 1 : column, dy < 0 ? row - 1 : row, dx != 0);
}

/// A tree of passages by depth-first search with random turns.
void carveTree(Canvas& canvas, core::RandomStream& random) {
  std::vector<bool> visited(size_t{kSide} * kSide, false);
  std::vector<int> path{0};
  visited[0] = true;
  while (!path.empty()) {
    const int column = path.back() % kSide, row = path.back() / kSide;
    struct Step {
      int dx, dy;
    };
    std::vector<Step> ways;
    for (const Step step : {Step{1, 0}, {0, 1}, {-1, 0}, {0, -1}}) {
      const int c = column + step.dx, r = row + step.dy;
      if (c >= 0 && r >= 0 && c < kSide && r < kSide && !visited[r * kSide + c]) ways.push_back(step);
    }
    if (ways.empty()) {
      path.pop_back();
      continue;
    }
    const Step step = ways[random.below(ways.size())];
    openBetween(canvas, column, row, step.dx, step.dy);
    path.push_back((row + step.dy) * kSide + column + step.dx);
    visited[path.back()] = true;
  }
}

}  // namespace

world::Plan makeMaze(std::uint64_t seed) {
  core::RandomStream random(seed, "maze");
  Canvas canvas(kSide * kPitch - kWall, kSide * kPitch - kWall);
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column) canvas.carve(cellRect(column, row));
  carveTree(canvas, random);
  // A few more openings make loops, without which nothing can be closed.
  for (int loops = 0; loops < 8; ++loops) {
    const int column = pick(random, 0, kSide - 2), row = pick(random, 0, kSide - 2);
    open(canvas, column, row, random.below(2) == 0);
  }
  canvas.raiseWalls(4);
  return canvas.plan("maze");
}

}  // namespace slam::buildings
