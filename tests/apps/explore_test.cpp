#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "libslam/files/files.h"
#include "libslam/resources/file_hash.h"
#include "tests/apps/program.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

TEST(ExploreCommand, PrintsOneRowPerStrategyAndWritesWhatItSays) {
  const testing::TempFolder folder;
  const std::string common =
      "explore flat --strategy quadrant,nearest_frontier --slam naive_wheel --duration 10 "
      "--set lidar.beams=91 ";
  const auto text = rasterslam(common + "-o text", folder.path());
  ASSERT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("Exploration of flat with naive_wheel"));
  EXPECT_THAT(text.out, HasSubstr("\nquadrant "));
  EXPECT_THAT(text.out, HasSubstr("\nnearest_frontier "));
  EXPECT_THAT(text.out, HasSubstr("duration"));
  EXPECT_TRUE(fs::exists(folder / "text/quadrant/run.rawlog"));
  const auto json = rasterslam(common + "--json --tables-only -o json --seeds 2", folder.path());
  ASSERT_EQ(json.exit_code, 0) << json.err;
  const auto scores = nlohmann::json::parse(json.out)["scores"];
  EXPECT_EQ(scores["rows"].size(), 4U);  // medians and quartiles
  EXPECT_FALSE(fs::exists(folder / "json/quadrant"));
  EXPECT_THAT(files::readTextFile(folder / "json/scores.csv"), HasSubstr("t90_s,t90_s_q1,t90_s_q3"));

  const auto again = rasterslam(common + "-o text", folder.path());
  EXPECT_EQ(again.exit_code, 3);
  EXPECT_THAT(again.err, HasSubstr("exists; give --overwrite"));
}

TEST(ExploreCommand, RefusesInOneLine) {
  const testing::TempFolder folder;
  const std::pair<const char*, const char*> refusals[] = {
      {"explore flatt", "did you mean 'flat'?"},
      {"explore flat --strategy quadrant,nearest_fronteer", "did you mean 'nearest_frontier'?"},
      {"explore flat --slam rbfp", "did you mean 'rbpf'?"},
      {"explore flat --set 'simulation.start=0 0 0'", "start"},
      {"explore flat --set 'simulation.start=-1 -1 0'", "start"},
      {"explore flat --set robot.side_m=9", "no free place"},
      {"explore flat --set exploration.stuck=9", "did you mean 'stuck_s'?"}};
  for (const auto& [arguments, what] : refusals) {
    const auto result = rasterslam(std::string(arguments) + " -q", folder.path());
    EXPECT_EQ(result.exit_code, 3) << arguments;
    EXPECT_THAT(result.err, HasSubstr(what)) << arguments;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(ExploreCommand, PrintsItsConfigurationWithTheReferee) {
  const auto result = rasterslam("explore flat --return --strategy quadrant,longest_ray --print-config");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, ::testing::ContainsRegex("return_to_start = true +# --return"));
  EXPECT_THAT(result.out, ::testing::ContainsRegex("give_up_s = 300 +# built-in"));
}

TEST(ExploreCommand, LetsSeveralRobotsExplore) {
  const testing::TempFolder folder;
  const std::string common =
      "explore flat --strategy nearest_frontier --slam truth --duration 8 --set lidar.beams=91 -q ";
  const auto team = rasterslam(common + "--robots 2 --radio-range 5 --json -o team", folder.path());
  ASSERT_EQ(team.exit_code, 0) << team.err;
  const auto json = nlohmann::json::parse(team.out);
  EXPECT_EQ(json["each"].size(), 2U);
  EXPECT_EQ(json["radio_range_m"], 5);
  EXPECT_EQ(json["robot_collisions"], 0);
  const auto report = rasterslam("report team -o team.html", folder.path());
  EXPECT_EQ(report.exit_code, 0) << report.err;
  const auto placed = rasterslam(
      "explore pillar_hall --strategy nearest_frontier --slam truth --duration 4 -q --robots 2 "
      "--starts 3,3,0 21,15,180 --tables-only -o placed",
      folder.path());
  EXPECT_EQ(placed.exit_code, 0) << placed.err;
  EXPECT_FALSE(fs::exists(folder / "placed/robot1"));
  // One robot is a single exploration, whether it is said or not.
  ASSERT_EQ(rasterslam(common + "-o one", folder.path()).exit_code, 0);
  ASSERT_EQ(rasterslam(common + "--robots 1 -o said", folder.path()).exit_code, 0);
  for (const char* file : {"run.rawlog", "map.gridmap.gz", "exploration.csv", "scores.csv", "path.png"})
    EXPECT_EQ(resources::fileSha256(folder / ("one/" + std::string(file))),
              resources::fileSha256(folder / ("said/" + std::string(file))))
        << file;
}

TEST(ExploreCommand, RefusesATeamThatCannotBeInOneLine) {
  const testing::TempFolder folder;
  const std::pair<const char*, const char*> refusals[] = {
      {"--robots 0", "--robots: found 0, expected 1 to 4"},
      {"--robots 5", "--robots: found 5, expected 1 to 4"},
      {"--robots 2 --radio-range -1", "--radio-range: found -1, expected metres from 0 on"},
      {"--radio-range 3", "--radio-range: found one robot"},
      {"--starts 3,3,0", "--starts: found one robot"},
      {"--robots 2 --seeds 3", "found --seeds 3"},
      {"--robots 2 --oracle", "found --oracle"},
      {"--robots 2 --return", "--return"},
      {"--robots 2 --carry 5:random", "--carry"},
      {"--robots 2 --set living.people=2", "people"},
      {"--robots 2 --strategy quadrant,longest_ray", "2 strategies"},
      {"--robots 2 --starts 3,3,0 3,3", "--starts"},
      {"--robots 2 --starts 3,3,0", "found 1 places, expected one for each of 2 robots"},
      {"--robots 2 --starts 3,3,0 -9,-9,0", "start of robot 2"},
      {"--robots 4 --set robot.side_m=1.5", "found room for 1 round the start"}};
  for (const auto& [arguments, what] : refusals) {
    const auto result = rasterslam("explore flat --slam truth -q " + std::string(arguments), folder.path());
    EXPECT_EQ(result.exit_code, 3) << arguments << result.err;
    EXPECT_THAT(result.err, HasSubstr(what)) << arguments;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(Explore, TablesAloneAreEnoughForTheFigure) {
  const testing::TempFolder folder;
  const std::string explore =
      "explore flat --strategy longest_ray,quadrant --seeds 2 --duration 20 -q --set lidar.beams=91 ";
  for (const std::string how : {"-o folders", "--tables-only -o tables"})
    ASSERT_EQ(rasterslam(explore + how, folder.path()).exit_code, 0) << how;
  const auto drawn = rasterslam("plot exploration tables -o tables.svg --json", folder.path());
  ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_THAT(drawn.out, ::testing::HasSubstr("\"runs\": 4"));
  ASSERT_EQ(rasterslam("plot exploration folders -o folders.svg", folder.path()).exit_code, 0);
}

}  // namespace
}  // namespace slam::apps
