#include <vector>

#include "libslam/buildings/drawn/buildings.h"
#include "libslam/buildings/drawn/canvas.h"

namespace slam::buildings {
namespace {

constexpr int kLength = 1200, kTop = 90, kBottom = 42;  // 60 m, 2.4 m
constexpr Rect kWestLobby{0, 22, 90, 116}, kEastLobby{1110, 0, 1200, 90};
constexpr int kDoor = 20, kRecess = 3;

/// Closed doors, each a recess; so few that between them a lidar sees two parallel lines only.
void carveDoors(Canvas& canvas, core::RandomStream& random) {
  constexpr int kFirst = 180, kSpacing = 220;
  for (int i = 0; i < 4; ++i) {
    const int x = kFirst + i * kSpacing + pick(random, 0, kSpacing / 2);
    if (random.below(2) == 0)
      canvas.carve({x, kTop, x + kDoor, kTop + kRecess});
    else
      canvas.carve({x, kBottom - kRecess, x + kDoor, kBottom});
  }
}

void furnishLobbies(Canvas& canvas, core::RandomStream& random) {
  canvas.placeAlong(random, kWestLobby, Side::kNorth, 36, 14);  // reception
  canvas.placeAlong(random, kWestLobby, Side::kSouth, 30, 14);  // a sofa
  canvas.placeInside(random, kWestLobby, 8, 8, Shape::kSolid);  // a pillar
  canvas.placeAlong(random, kEastLobby, Side::kSouth, 28, 14, Shape::kDesk);
  canvas.placeAlong(random, kEastLobby, Side::kEast, 40, 10);
  canvas.placeAlong(random, kEastLobby, Side::kWest, 8, 8, Shape::kDisc);
}

}  // namespace

world::Plan makeCorridor(std::uint64_t seed) {
  core::RandomStream random(seed, "corridor");
  Canvas canvas(kLength, kWestLobby.y1);
  canvas.carve({0, kBottom, kLength, kTop});
  canvas.carve(kWestLobby);
  canvas.carve(kEastLobby);
  carveDoors(canvas, random);
  canvas.raiseWalls(4);
  furnishLobbies(canvas, random);
  return canvas.plan("corridor");
}

}  // namespace slam::buildings
