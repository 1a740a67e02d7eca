#include "libslam/rays/sector_table.h"

#include <gtest/gtest.h>

#include <cstring>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "tests/world/drawn_plan.h"

namespace slam::rays {
namespace {

bool sameCodes(const SectorTable& a, const SectorTable& b) {
  const auto size =
      static_cast<size_t>(a.codes(Octant{false, false, true}) - a.codes(Octant{false, false, false}));
  return std::memcmp(a.codes(Octant{false, false, false}), b.codes(Octant{false, false, false}), 8 * size) ==
         0;
}

void fill(world::Plan& plan, int x0, int y0, int x1, int y1, world::Cell cell) {
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) plan.cells[static_cast<size_t>(y) * plan.columns + x] = cell;
}

TEST(SectorTable, CountsTheColumnsThatAreFreeForEverySlope) {
  const world::Plan plan = world::drawnPlan({"....#",  //
                                             ".....",  //
                                             "....."});
  const SectorTable table(plan);
  const Octant right_and_up{true, false, false};
  const auto at = [&](int u, int v) {
    return int{table.codes(right_and_up)[SectorTable::offsetOf(table.tiles(right_and_up), u, v)]};
  };
  EXPECT_EQ(at(4, 2), kWall);
  EXPECT_EQ(at(4, 1), kWallAbove);
  EXPECT_EQ(at(3, 1), 2);  // its own column only: at the next the wall may be above
  EXPECT_EQ(at(2, 0), 3);
  EXPECT_EQ(at(4, 0), kNeverHits);  // nothing but the outside ahead
  EXPECT_EQ(at(5, 0), kNeverHits);
  EXPECT_EQ(at(0, 3), kNeverHits);
}

TEST(SectorTable, AnUpdateGivesTheTableThatANewOneWouldBe) {
  for (const int one_in : {5, 200, 5000}) {
    world::Plan plan = world::scatteredPlan(330, 270, 1, one_in);
    SectorTable table(plan);
    core::RandomStream random(2, "update");
    for (int i = 0; i < 60; ++i) {
      const int x0 = static_cast<int>(random.below(330)), y0 = static_cast<int>(random.below(270));
      const int x1 = std::min(330, x0 + 1 + static_cast<int>(random.below(20)));
      const int y1 = std::min(270, y0 + 1 + static_cast<int>(random.below(20)));
      fill(plan, x0, y0, x1, y1, random.below(2) == 0 ? world::Cell::kOccupied : world::Cell::kFree);
      table.update(plan, x0, y0, x1, y1);
      if (i % 6 == 0) {
        ASSERT_TRUE(sameCodes(table, SectorTable(plan))) << one_in << " " << i;
      }
    }
    EXPECT_TRUE(sameCodes(table, SectorTable(plan)));
  }
}

TEST(SectorTable, AnUpdateReachesTheBordersAndIgnoresWhatIsOutside) {
  world::Plan plan = world::scatteredPlan(40, 30, 1, 1000000);
  SectorTable table(plan);
  fill(plan, 0, 0, 40, 1, world::Cell::kOccupied);
  table.update(plan, -5, -5, 45, 1);
  EXPECT_TRUE(sameCodes(table, SectorTable(plan)));
  fill(plan, 39, 0, 40, 30, world::Cell::kOccupied);
  table.update(plan, 39, 0, 100, 100);
  EXPECT_TRUE(sameCodes(table, SectorTable(plan)));
  table.update(plan, 50, 0, 60, 10);
  table.update(plan, 5, 5, 5, 9);
  EXPECT_TRUE(sameCodes(table, SectorTable(plan)));
  EXPECT_THROW(table.update(world::scatteredPlan(41, 30, 1, 10), 0, 0, 1, 1), core::ContractError);
}

}  // namespace
}  // namespace slam::rays
