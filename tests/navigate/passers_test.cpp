#include "libslam/navigate/passers.h"

#include <gtest/gtest.h>

namespace slam::navigate {
namespace {

/// Free space of 6 x 4 m, walls around it.
paths::FreeSpace hall() {
  gridmap::OccupancyRaster map;
  map.columns = 120, map.rows = 80, map.resolution_m = 0.05;
  map.occupancy.assign(static_cast<size_t>(map.columns * map.rows), 0.0F);
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column)
      if (row == 0 || column == 0 || row == map.rows - 1 || column == map.columns - 1)
        map.occupancy[static_cast<size_t>(row * map.columns + column)] = 1.0F;
  return paths::readFreeSpace(map);
}

std::vector<core::Point2> legAt(const core::Point2& p) {
  return {{p.x - 0.04, p.y}, {p.x, p.y - 0.03}, {p.x + 0.04, p.y}};
}

void put(paths::FreeSpace& space, const std::vector<core::Point2>& points) {
  for (const auto& p : points)
    space.state[space.index(space.columnOf(p.x), space.rowOf(p.y))] = paths::kOccupiedCell;
}

bool isFree(const paths::FreeSpace& space, const core::Point2& p) {
  return space.at(p) == paths::kFreeCell;
}

TEST(Passers, AreTakenOutOfTheMapOnceTheyAreSeenNoMore) {
  Passers passers;
  const auto before = hall();
  passers.see(legAt({3, 2}), before);
  EXPECT_TRUE(passers.areAbout());
  EXPECT_FALSE(passers.bodies().empty());
  auto map = before;
  put(map, legAt({3, 2}));
  passers.takeOutOf(map);
  EXPECT_FALSE(isFree(map, {3, 2})) << "still there";
  passers.see({}, before);
  EXPECT_TRUE(passers.bodies().empty());
  passers.takeOutOf(map);
  EXPECT_TRUE(isFree(map, {3, 2}));
  EXPECT_FALSE(isFree(map, {0.01, 2})) << "a wall is no person";
  for (int i = 0; i < 20; ++i) passers.see({}, before);
  EXPECT_FALSE(passers.areAbout()) << "one scan of twenty may err";
}

TEST(Passers, AreNoWallsThatStandWhereTheyShouldNot) {
  // The pose errs: a whole wall is seen amid free space, and a corner of one that goes on.
  Passers passers;
  std::vector<core::Point2> wall;
  for (double y = 0.5; y < 3.5; y += 0.04) wall.push_back({5.5, y});
  passers.see(wall, hall());
  EXPECT_FALSE(passers.areAbout());
  auto corner = legAt({5.6, 0.3});
  for (double y = 0.3; y > 0.03; y -= 0.04) corner.push_back({5.6, y});
  passers.see(corner, hall());
  EXPECT_FALSE(passers.areAbout());
}

TEST(Passers, ThatNobodySawComeAreSuspectedAmongSmallThingsOnly) {
  Passers passers;
  auto map = hall();
  put(map, legAt({2, 1}));
  std::vector<core::Point2> cupboard;
  for (double x = 4; x < 4.8; x += 0.05) cupboard.push_back({x, 3});
  put(map, cupboard);
  passers.suspectSmallThings();
  passers.takeOutOf(map);
  EXPECT_FALSE(isFree(map, {2, 1})) << "nobody is about";
  passers.see(legAt({3, 2}), hall());
  passers.takeOutOf(map);
  EXPECT_TRUE(isFree(map, {2, 1}));
  EXPECT_FALSE(isFree(map, {4.4, 3}));
}

}  // namespace
}  // namespace slam::navigate
