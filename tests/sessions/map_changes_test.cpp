#include "libslam/sessions/map_changes.h"

#include <gtest/gtest.h>

namespace slam::sessions {
namespace {

using world::Cell;
using world::CellMap;

/// 4 x 3 m of free floor, walls around it, beyond them nothing known.
CellMap room() {
  CellMap map;
  map.columns = 100, map.rows = 80, map.resolution_m = 0.05;
  map.cells.assign(8000, Cell::kUnknown);
  for (int row = 9; row <= 70; ++row)
    for (int column = 9; column <= 90; ++column) {
      const bool is_wall = row == 9 || row == 70 || column == 9 || column == 90;
      map.cells[static_cast<size_t>(row) * 100 + column] = is_wall ? Cell::kOccupied : Cell::kFree;
    }
  return map;
}

void put(CellMap& map, int column, int row, int width, int height, Cell what = Cell::kOccupied) {
  for (int r = row; r < row + height; ++r)
    for (int c = column; c < column + width; ++c) map.cells[static_cast<size_t>(r) * map.columns + c] = what;
}

TEST(MapChanges, ATableThatWasMovedIsGoneHereAndNewThere) {
  CellMap before = room(), after = room();
  put(before, 20, 20, 10, 6);
  put(after, 60, 40, 10, 6);
  const auto found = findChanges(before, after);
  ASSERT_EQ(found.changes.size(), 2U);
  const auto& fresh = found.changes[0];
  const auto& gone = found.changes[1];
  EXPECT_EQ(fresh.kind, MapChange::Kind::kNew);
  EXPECT_NEAR(fresh.least.x, 3.0, 1e-9);
  EXPECT_NEAR(fresh.most.x, 3.5, 1e-9);
  EXPECT_NEAR(fresh.centre().y, 2.15, 1e-9);
  EXPECT_NEAR(fresh.area_m2, 60 * 0.0025, 1e-9);
  EXPECT_EQ(gone.kind, MapChange::Kind::kGone);
  EXPECT_NEAR(gone.centre().x, 1.25, 1e-9);
  EXPECT_NEAR(found.compared_m2, 62 * 82 * 0.0025, 1e-9);
}

TEST(MapChanges, WhatIsSeenForTheFirstTimeIsNoChange) {
  CellMap before = room(), after = room();
  put(before, 50, 10, 40, 60, Cell::kUnknown);
  put(after, 60, 40, 10, 6);
  EXPECT_TRUE(findChanges(before, after).changes.empty());
}

TEST(MapChanges, AWallThatIsSeenALittleAsideIsNoChange) {
  CellMap before = room(), after = room();
  put(before, 40, 10, 1, 30);
  put(after, 42, 10, 1, 30);  // 0.1 m
  EXPECT_TRUE(findChanges(before, after).changes.empty());
  put(after, 42, 10, 1, 30, Cell::kFree);
  put(after, 46, 10, 1, 30);  // 0.3 m
  EXPECT_EQ(findChanges(before, after).changes.size(), 2U);
}

TEST(MapChanges, OneCellIsNoiseAndPiecesNearOneAnotherAreOneThing) {
  CellMap before = room(), after = room();
  put(after, 20, 20, 1, 1);
  EXPECT_TRUE(findChanges(before, after).changes.empty());
  // The four legs of a table, and one of another.
  for (const int column : {40, 44})
    for (const int row : {40, 44}) put(after, column, row, 1, 1);
  put(after, 70, 40, 3, 3);
  const auto found = findChanges(before, after);
  ASSERT_EQ(found.changes.size(), 2U);
  EXPECT_NEAR(found.changes[0].most.x - found.changes[0].least.x, 0.25, 1e-9);
}

TEST(MapChanges, MapsMayLieTurnedToOneAnother) {
  CellMap before = room(), after = room();
  put(before, 20, 20, 10, 6);
  // The same room drawn from the other corner.
  after.T_frame_raster = core::Pose2{5, 4, core::kPi};
  put(after, 70, 54, 10, 6);
  EXPECT_TRUE(findChanges(before, after).changes.empty());
}

}  // namespace
}  // namespace slam::sessions
