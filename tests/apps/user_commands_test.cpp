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

const std::string kStart = "simulate flat --set 'simulation.start=3 3 0' --set lidar.beams=181 ";

void write(const std::string& path, const std::string& text) {
  files::writeFileAtomically(path, text);
}

TEST(UserCommands, DriveARobotAndSayWhatBecameOfThem) {
  const testing::TempFolder folder;
  write(folder / "drive.txt", "# to the wall and back\nmove 0.5\nturn 180\nmove 50\nmove -0.5\n");
  const auto result = rasterslam(kStart + "--commands drive.txt", folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("5 scans in "));
  EXPECT_THAT(result.out, HasSubstr("line 4: move 50 ended at an obstacle after "));
  const auto operations = files::readTextFile(folder / "run.operations.txt");
  EXPECT_EQ(std::count(operations.begin(), operations.end(), '\n'), 4);
  const auto again = rasterslam(kStart + "--commands - -o b.rawlog --json < drive.txt", folder.path());
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const auto json = nlohmann::json::parse(again.out);
  EXPECT_EQ(json["commands_left"], 0);
  EXPECT_EQ(json["stopped"].at(0)["line"], 4);
  EXPECT_EQ(resources::fileSha256(folder / "run.rawlog"), resources::fileSha256(folder / "b.rawlog"));
}

TEST(UserCommands, AreRefusedInOneLineBeforeAnythingIsWritten) {
  const testing::TempFolder folder;
  write(folder / "bad.txt", "move 1\nturn left\n");
  write(folder / "empty.txt", "# nothing\n");
  const std::pair<const char*, const char*> refusals[] = {
      {"--commands bad.txt", "bad.txt:2: found 'turn left', expected 'move METRES'"},
      {"--commands empty.txt", "empty.txt: holds no command"},
      {"--commands none.txt", "none.txt: no such file"},
      {"--carry 60", "--carry: found '60', expected TIME_S:X_M,Y_M,HEADING_DEG"},
      {"--carry 60:0,0,0", "--carry: the place at 60 s (0.000 m, 0.000 m, 0.0 deg) is too near to a wall"},
      {"--carry 60:99,0,0", "is outside the plan"},
      {"--carry -3:3,3,0", "expected a time above 0"},
      {"--carry 700:3,3,0", "expected one before the end at 600 s"},
      {"--set events.carry=60", "--set: found '60'"}};
  for (const auto& [arguments, what] : refusals) {
    const auto result = rasterslam(kStart + arguments, folder.path());
    EXPECT_EQ(result.exit_code, 3) << arguments;
    EXPECT_THAT(result.err, HasSubstr(what)) << arguments;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(fs::exists(folder / "run.rawlog"));
  }
  EXPECT_EQ(rasterslam(kStart + "--commands bad.txt --strategy quadrant", folder.path()).exit_code, 2);
}

TEST(Carry, HappensInSimulateExploreAndNavigate) {
  const testing::TempFolder folder;
  const std::string options = " --carry 5:11,3,90 --set lidar.beams=181 ";
  const auto simulated = rasterslam("simulate flat --duration 10 -o run.rawlog" + options, folder.path());
  ASSERT_EQ(simulated.exit_code, 0) << simulated.err;
  EXPECT_THAT(simulated.out, HasSubstr("kidnapped at 5.0 s from ("));
  EXPECT_TRUE(fs::exists(folder / "run.carries.csv"));
  const auto explored = rasterslam(
      "explore flat --slam naive_wheel --strategy longest_ray --duration 10 -o e" + options, folder.path());
  ASSERT_EQ(explored.exit_code, 0) << explored.err;
  EXPECT_THAT(explored.out, HasSubstr("kidnapped at 5.0 s"));
  EXPECT_TRUE(fs::exists(folder / "e/run.carries.csv"));
  const auto navigated = rasterslam("navigate flat --goal '11 7' --method bug2 --slam odometry -o n" +
                                        options + " --set navigate.time_limit_s=20",
                                    folder.path());
  EXPECT_NE(navigated.exit_code, 3) << navigated.err;
  EXPECT_THAT(navigated.out, HasSubstr("kidnapped at 5.0 s"));
  EXPECT_TRUE(fs::exists(folder / "n/bug2/run.carries.csv"));
}

}  // namespace
}  // namespace slam::apps
