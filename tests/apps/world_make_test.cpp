#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "libslam/buildings/building.h"
#include "libslam/buildings/generator.h"
#include "libslam/files/files.h"
#include "tests/apps/program.h"

namespace slam::apps {
namespace {
using ::testing::HasSubstr;

TEST(WorldMake, WritesAPlanThatARobotCanExplore) {
  const testing::TempFolder folder;
  const auto made = rasterslam("world make office -o here.yaml --size 20x14 --seed 7", folder.path());
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("20 x 14 m, 400 x 280 cells of 0.05 m, "));
  EXPECT_THAT(made.out, HasSubstr("next: rasterslam simulate here.yaml\n"));
  buildings::BuildingOptions options;
  options.width_m = 20, options.height_m = 14;
  const auto plan = world::loadPlan(folder / "here.yaml");
  EXPECT_TRUE(plan.cells == buildings::generateBuilding("office", options, 7).plan.cells);
  const auto run = rasterslam("simulate here.yaml --duration 5", folder.path());
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr(" 0 collisions"));
}

TEST(WorldMake, SaysTheSameInJsonAndDrawsAPreview) {
  const testing::TempFolder folder;
  const auto made =
      rasterslam("world make flat --size 11x8 --resolution 0.1 --set building.glass=1 --json --preview p.png",
                 folder.path());
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const auto json = nlohmann::json::parse(made.out);
  EXPECT_EQ(json["kind"], "flat");
  EXPECT_EQ(json["columns"], 110);
  EXPECT_EQ(json["rows"], 80);
  EXPECT_GT(json["rooms"], 2);
  EXPECT_GT(json["doors"], 1);
  EXPECT_GT(json["free_m2"], 30.0);
  EXPECT_GT(json["glass_cells"], 0);
  ASSERT_EQ(json["files"].size(), 4U);  // yaml, picture, materials, preview
  const auto plan = world::loadPlan(folder / "flat.yaml");
  EXPECT_EQ(std::count(plan.materials.begin(), plan.materials.end(), world::Material::kGlass),
            json["glass_cells"]);
  for (const std::string file : json["files"]) EXPECT_TRUE(std::filesystem::exists(folder / file)) << file;
  EXPECT_TRUE(std::filesystem::exists(folder / "p.png"));
}

TEST(WorldMake, DrawsTheWorldsOfFixedSizeToo) {
  const testing::TempFolder folder;
  const auto made = rasterslam("world make maze --seed 3", folder.path());
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_TRUE(world::loadPlan(folder / "maze.yaml").cells == buildings::makeBuilding("maze", 3).cells);
}

TEST(WorldMake, IsListedAndDrawnSideBySide) {
  const testing::TempFolder folder;
  const auto list = rasterslam("list buildings --json");
  const auto kinds = nlohmann::json::parse(list.out);
  ASSERT_EQ(kinds.size(), buildings::buildingKinds().size());
  std::string plans;
  for (const auto& kind : kinds) {
    const std::string name = kind["name"];
    const auto made = rasterslam("world make " + name + " --size 17x15 --resolution 0.1", folder.path());
    ASSERT_EQ(made.exit_code, 0) << made.err;
    plans += " " + name + ".yaml";
  }
  const auto drawn = rasterslam("plot plans" + plans + " -o sheet.png", folder.path());
  EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "sheet.png"));
}

}  // namespace
}  // namespace slam::apps
