#include "libslam/buildings/drawn/buildings.h"
#include "libslam/buildings/drawn/canvas.h"

namespace slam::buildings {
namespace {

constexpr Rect kLiving{0, 0, 117, 77}, kDining{0, 77, 57, 104}, kKitchen{120, 0, 177, 77};
constexpr Rect kBath{180, 0, 240, 77}, kHall{60, 80, 240, 104};
constexpr Rect kBedroom{0, 107, 87, 180}, kStudy{90, 107, 157, 180}, kGuests{160, 107, 240, 180};

void carveRooms(Canvas& canvas) {
  for (const Rect& room : {kLiving, kDining, kKitchen, kBath, kHall, kBedroom, kStudy, kGuests})
    canvas.carve(room);
}

void carveDoors(Canvas& canvas, core::RandomStream& random) {
  const int shift = pick(random, -2, 2);
  canvas.carve({57, 82, 60, 102});                     // dining corner - hall, no door in it
  canvas.carve({63, 104, 81, 107});                    // hall - bedroom
  canvas.carve({112 + shift, 104, 130 + shift, 107});  // hall - study
  canvas.carve({182 + shift, 104, 200 + shift, 107});  // hall - guests
  canvas.carve({140 - shift, 77, 160 - shift, 80});    // hall - kitchen
  canvas.carve({205 - shift, 77, 223 - shift, 80});    // hall - bath
  canvas.carve({117, 30 + shift, 120, 50 + shift});    // living room - kitchen
  canvas.carve({240, 83, 242, 101});                   // the closed front door, a shallow recess
}

void hollowWindows(Canvas& canvas) {
  constexpr int kDepth = 2;
  canvas.recess(kLiving, Side::kSouth, 15, 30, kDepth);
  canvas.recess(kLiving, Side::kSouth, 66, 36, kDepth);
  canvas.recess(kLiving, Side::kWest, 52, 40, kDepth);
  canvas.recess(kKitchen, Side::kSouth, 18, 24, kDepth);
  canvas.recess(kBath, Side::kSouth, 20, 15, kDepth);
  canvas.recess(kBedroom, Side::kNorth, 25, 36, kDepth);
  canvas.recess(kStudy, Side::kNorth, 8, 50, kDepth);
  canvas.recess(kGuests, Side::kNorth, 22, 36, kDepth);
}

void furnishLiving(Canvas& canvas, core::RandomStream& random) {
  canvas.placeAt(kLiving, Side::kNorth, 73, 44, 17);                   // sofa
  canvas.placeAt(kLiving, Side::kSouth, pick(random, 46, 58), 36, 8);  // television
  canvas.placeAt(kLiving, Side::kWest, pick(random, 12, 18), 32, 7);   // bookshelf
  canvas.placeAt(kLiving, Side::kSouth, 108, 9, 9, Shape::kDisc);      // plant in the corner
  const int table = pick(random, 74, 80);
  canvas.place({table, 32, table + 20, 43}, Shape::kLegs);
  const int x = pick(random, 13, 19), y = pick(random, 70, 74);
  constexpr int kChair = 8;
  canvas.place({x, y, x + 26, y + 16}, Shape::kLegs);  // dining table, its chairs half under it
  for (const int dx : {3, 15})
    for (const int dy : {-5, 13}) canvas.fillDisc({x + dx, y + dy, x + dx + kChair, y + dy + kChair});
}

void furnishKitchenAndBath(Canvas& canvas, core::RandomStream& random) {
  canvas.placeAt(kKitchen, Side::kEast, 0, pick(random, 56, 65), 12);  // counter
  canvas.placeAt(kKitchen, Side::kSouth, 0, 13, 13);                   // fridge
  canvas.placeAt(kBath, Side::kEast, 0, 34, 15);                       // tub
  canvas.placeAt(kBath, Side::kWest, pick(random, 34, 40), 13, 9);     // basin
  canvas.placeAt(kBath, Side::kWest, pick(random, 12, 14), 8, 13);     // toilet
  canvas.placeAt(kBath, Side::kEast, 65, 12, 12);                      // washing machine
}

void furnishBedrooms(Canvas& canvas, core::RandomStream& random) {
  canvas.placeAt(kBedroom, Side::kWest, pick(random, 18, 26), 34, 41);  // double bed
  canvas.placeAt(kBedroom, Side::kEast, 37, 36, 12);                    // wardrobe
  canvas.placeAt(kBedroom, Side::kSouth, pick(random, 13, 24), 18, 5);  // chest
  canvas.placeAt(kStudy, Side::kNorth, pick(random, 20, 26), 28, 14, Shape::kDesk);
  canvas.placeAt(kStudy, Side::kWest, pick(random, 13, 24), 32, 7);  // bookshelf
  canvas.placeAt(kStudy, Side::kEast, 0, 9, 9, Shape::kDisc);        // plant in the corner
  canvas.placeAt(kGuests, Side::kEast, 33, 40, 20);                  // bed
  canvas.placeAt(kGuests, Side::kWest, 43, 30, 12);                  // wardrobe
  canvas.placeAt(kGuests, Side::kEast, 0, 21, 14, Shape::kDesk);
  canvas.placeAt(kHall, Side::kSouth, pick(random, 16, 56), 18, 6);  // shoes
}

}  // namespace

world::Plan makeFlat(std::uint64_t seed) {
  core::RandomStream random(seed, "flat");
  Canvas canvas(240, 180);
  carveRooms(canvas);
  carveDoors(canvas, random);
  canvas.raiseWalls(5);
  furnishLiving(canvas, random);
  furnishKitchenAndBath(canvas, random);
  furnishBedrooms(canvas, random);
  hollowWindows(canvas);
  return canvas.plan("flat");
}

}  // namespace slam::buildings
