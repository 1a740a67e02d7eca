#include "libslam/choices/looking_map.h"

#include <gtest/gtest.h>

#include "libslam/paths/close_walls.h"
#include "tests/paths/kept_map.h"

namespace slam::choices {
namespace {

/// As made from nothing.
paths::FreeSpace fresh(const gridmap::OccupancyRaster& map,
                       const std::function<bool(std::size_t cell)>& is_false, double gap_m) {
  auto space = paths::readFreeSpace(map);
  for (const std::size_t cell : paths::frontierCells(space))
    if (is_false(cell)) space.state[cell] = paths::kOccupiedCell;
  if (gap_m > 0) paths::closeWalls(space, gap_m);
  return space;
}

void expectTheSameWhateverChanges(double gap_m) {
  core::RandomStream random(5, "looking map");
  auto map = paths::unknownRaster(60, 50);
  paths::FreeSpace space;
  LookingMap kept;
  std::size_t falser = 7;  // other cells are false each time
  std::size_t closed = 0;
  for (const auto& [first, last] :
       {std::pair(std::pair(0, 0), std::pair(60, 50)), std::pair(std::pair(20, 20), std::pair(30, 31)),
        std::pair(std::pair(0, 0), std::pair(60, 1)), std::pair(std::pair(7, 8), std::pair(7, 8))}) {
    paths::strew(map, first, last, first.first == 0 ? 1500 : 60, random);
    map.x_min_m += 1;
    const auto is_false = [&](std::size_t cell) { return cell % falser == 0; };
    kept.update(space, paths::updateFreeSpace(map, space));
    kept.close(space, is_false, gap_m);
    const auto expected = fresh(map, is_false, gap_m);
    EXPECT_EQ(kept.space().state, expected.state);
    EXPECT_EQ(kept.space().x_min_m, expected.x_min_m);
    EXPECT_EQ(kept.space().known, expected.known);
    EXPECT_EQ(kept.frontierCells(), paths::frontierCells(expected));
    for (std::size_t cell = 0; cell < space.state.size(); ++cell)
      closed += space.state[cell] != expected.state[cell];
    --falser;
  }
  EXPECT_GT(closed, 100u);
}

TEST(LookingMap, IsTheSameAsAFreshOneWhateverChanges) {
  expectTheSameWhateverChanges(0);
}

TEST(LookingMap, IsTheSameAsAFreshOneWithWallsThatGoOn) {
  expectTheSameWhateverChanges(0.3);
}

TEST(LookingMap, StartsAnewWithAMapOfAnotherSize) {
  core::RandomStream random(6, "looking map");
  paths::FreeSpace space;
  LookingMap kept;
  const auto is_false = [](std::size_t cell) { return cell % 3 == 0; };
  for (const int rows : {40, 30}) {
    auto map = paths::unknownRaster(30, rows);
    paths::strew(map, {0, 0}, {30, rows}, 700, random);
    kept.update(space, paths::updateFreeSpace(map, space));
    kept.close(space, is_false, 0.3);
    EXPECT_EQ(kept.space().state, fresh(map, is_false, 0.3).state);
  }
}

}  // namespace
}  // namespace slam::choices
