#include "libslam/world/cell_map.h"

#include <gtest/gtest.h>

#include "libslam/testing/temp_folder.h"
#include "tests/world/drawn_plan.h"

namespace slam::world {
namespace {

TEST(CellMaps, AreAPlansCellsWithoutMaterialsAndDoors) {
  const testing::TempFolder folder;
  Plan plan = drawnPlan({"#?.G", "...."}, 0.1);
  plan.T_frame_raster = {1, -2, 0.5};
  plan.doors = {{0, 0, 1, 1}};
  savePlan(plan, folder / "plan.yaml");
  const CellMap cells = loadCellMap(folder / "plan.yaml");
  EXPECT_EQ(cells.name, "plan");
  EXPECT_EQ(cells.cells, plan.cells);
  saveCellMap(cells, folder / "cells.yaml");
  const Plan loaded = loadPlan(folder / "cells.yaml");
  EXPECT_EQ(loaded.cells, plan.cells);
  EXPECT_EQ(loaded.T_frame_raster.phi, 0.5);
  EXPECT_TRUE(loaded.materials.empty());
  EXPECT_TRUE(loaded.doors.empty());
}

TEST(CellMaps, MayBeWithoutWallsOrFreeSpace) {
  const testing::TempFolder folder;
  for (const auto* const row : {"?..", "?##", "???"}) {
    const CellMap map = drawnPlan({row});
    saveCellMap(map, folder / "map.yaml");
    EXPECT_EQ(loadCellMap(folder / "map.yaml").cells, map.cells) << row;
  }
}

}  // namespace
}  // namespace slam::world
