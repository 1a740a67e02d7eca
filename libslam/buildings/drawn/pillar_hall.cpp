#include "libslam/buildings/drawn/buildings.h"
#include "libslam/buildings/drawn/canvas.h"

namespace slam::buildings {
namespace {

constexpr Rect kHall{0, 0, 500, 400};
constexpr Rect kOffice{403, 303, 500, 400};  // a foreman's office in the north-east corner
constexpr int kBay = 84;                     // between pillars

void carveRooms(Canvas& canvas) {
  canvas.carve({kHall.x0, kHall.y0, kHall.x1, kOffice.y0 - 3});
  canvas.carve({kHall.x0, kOffice.y0 - 3, kOffice.x0 - 3, kHall.y1});
  canvas.carve(kOffice);
  canvas.carve({425, kOffice.y0 - 3, 445, kOffice.y0});
  // Two gates and a door, closed: shallow recesses.
  canvas.carve({-4, 60, 0, 120});
  canvas.carve({-4, 230, 0, 290});
  canvas.carve({300, -3, 320, 0});
}

void raisePillars(Canvas& canvas, core::RandomStream& random) {
  for (int x = 66; x < kHall.x1; x += kBay)
    for (int y = 64; y < kHall.y1; y += kBay) {
      const bool round = random.below(3) == 0;
      const int size = round ? 12 : 8;
      const Rect pillar{x - size / 2, y - size / 2, x + size / 2, y + size / 2};
      canvas.place(pillar, round ? Shape::kDisc : Shape::kSolid);
    }
}

void raisePilasters(Canvas& canvas) {
  for (int x = 66; x < kHall.x1; x += kBay) {
    canvas.placeAt(kHall, Side::kSouth, x - 4, 8, 5);
    canvas.placeAt(kHall, Side::kNorth, x - 4, 8, 5);
  }
  for (int y = 64; y < kHall.y1; y += kBay) canvas.placeAt(kHall, Side::kEast, y - 4, 8, 5);
}

void furnish(Canvas& canvas, core::RandomStream& random) {
  for (int racks = 0; racks < 7; ++racks) {
    const bool lengthwise = random.below(4) != 0;
    const int length = pick(random, 54, 96), depth = 16;
    canvas.placeInside(random, kHall, lengthwise ? length : depth, lengthwise ? depth : length,
                       Shape::kSolid);
  }
  for (int shelves = 0; shelves < 6; ++shelves) {
    const int length = pick(random, 36, 70);
    canvas.placeAlong(random, kHall, pickSide(random), length, 10);
  }
  for (int pallets = 0; pallets < 12; ++pallets)
    canvas.placeInside(random, kHall, 24, 16, random.below(3) == 0 ? Shape::kLegs : Shape::kSolid);
  for (int drums = 0; drums < 6; ++drums) canvas.placeInside(random, kHall, 12, 12, Shape::kDisc);
  canvas.placeAlong(random, kOffice, Side::kNorth, 28, 14, Shape::kDesk);
  canvas.placeAlong(random, kOffice, Side::kEast, 28, 14, Shape::kDesk);
  canvas.placeAlong(random, kOffice, Side::kWest, 30, 8);
}

}  // namespace

world::Plan makePillarHall(std::uint64_t seed) {
  core::RandomStream random(seed, "pillar_hall");
  Canvas canvas(kHall.width(), kHall.height());
  carveRooms(canvas);
  canvas.raiseWalls(5);
  raisePilasters(canvas);
  raisePillars(canvas, random);
  furnish(canvas, random);
  return canvas.plan("pillar_hall");
}

}  // namespace slam::buildings
