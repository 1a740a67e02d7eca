#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "libslam/resources/file_hash.h"
#include "tests/apps/program.h"
#include "tests/check/architect_plan.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

void drawPlan(const testing::TempFolder& folder) {
  cv::imwrite(folder / "plan.png", check::ArchitectPlan(check::ArchitectStyle{}).sheet());
}

TEST(WorldCheck, SaysThatACommittedWorldHasNothingToMend) {
  const auto result = rasterslam("world check flat");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("nothing to mend"));
  EXPECT_THAT(result.out, HasSubstr("272 x 212 pixels of 0.05 m"));
  EXPECT_THAT(result.out, HasSubstr("passages"));
}

/// Two rooms with a passage between them, the left one open to the outside by 3 m.
void drawOpenRooms(const testing::TempFolder& folder) {
  cv::Mat picture(240, 320, CV_8U, cv::Scalar(255));
  const auto box = [&](int x, int y, int width, int height, int gray) {
    picture(cv::Rect(x, y, width, height)).setTo(gray);
  };
  box(30, 20, 250, 190, 0), box(34, 24, 119, 182, 255), box(157, 24, 119, 182, 255);
  box(153, 60, 4, 30, 255), box(30, 100, 4, 60, 255);
  cv::imwrite(folder / "plan.png", picture);
}

TEST(WorldCheck, StopsBeforeMendingThatTakesRoomsAway) {
  const testing::TempFolder folder;
  drawOpenRooms(folder);
  const auto stopped = rasterslam("world check plan.png --fix", folder.path());
  EXPECT_EQ(stopped.exit_code, 3);
  EXPECT_THAT(stopped.err, HasSubstr("plan.png: mending would make unknown 5"));
  EXPECT_THAT(stopped.err, HasSubstr("of the free space amid the walls; close the outline"));
  EXPECT_FALSE(fs::exists(folder / "plan.fixed.yaml"));
  const auto mended = rasterslam("world check plan.png --fix --yes", folder.path());
  EXPECT_EQ(mended.exit_code, 0) << mended.err;
  EXPECT_THAT(mended.out, HasSubstr("made unknown: 5"));
  EXPECT_TRUE(fs::exists(folder / "plan.fixed.yaml"));
}

TEST(WorldCheck, SaysThatDoorwaysAreToBeOpenedWhereRoomsAreShutIn) {
  const testing::TempFolder folder;
  cv::Mat picture(240, 320, CV_8U, cv::Scalar(255));
  for (const int x : {30, 153}) cv::rectangle(picture, {x, 30, 124, 180}, cv::Scalar(0), 4);
  cv::imwrite(folder / "plan.png", picture);
  const auto stopped = rasterslam("world check plan.png --fix --resolution 0.05", folder.path());
  EXPECT_EQ(stopped.exit_code, 3) << stopped.out;
  EXPECT_THAT(stopped.err, HasSubstr("open the doorways in the drawing"));
}

TEST(WorldCheck, SimulationsWarnOfWhatItFinds) {
  const testing::TempFolder folder;
  drawOpenRooms(folder);
  const std::string simulate = "simulate plan.png --duration 2 --overwrite ";
  const auto warned = rasterslam(simulate, folder.path());
  EXPECT_EQ(warned.exit_code, 0);
  EXPECT_THAT(warned.err, HasSubstr("warning: plan.png: the inside is open to the outside"));
  EXPECT_THAT(warned.err, HasSubstr("'rasterslam world check plan.png' says more"));
  EXPECT_THAT(rasterslam(simulate + "-q", folder.path()).err, Not(HasSubstr("warning")));
  EXPECT_THAT(rasterslam("simulate flat -o flat.rawlog --duration 2", folder.path()).err,
              Not(HasSubstr("warning")));
}

TEST(WorldCheck, KeepsToEightyColumns) {
  const testing::TempFolder folder;
  drawPlan(folder);
  std::istringstream lines(rasterslam("world check plan.png", folder.path()).out);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
}

TEST(WorldCheck, MendsAPlanInWhichTheRobotThenDrives) {
  const testing::TempFolder folder;
  drawPlan(folder);
  const std::string original = resources::fileSha256(folder / "plan.png");
  const auto fixed = rasterslam("world check plan.png --fix", folder.path());
  ASSERT_EQ(fixed.exit_code, 0) << fixed.err;
  EXPECT_THAT(fixed.out, HasSubstr("\nnothing to mend\nsize"));
  EXPECT_EQ(resources::fileSha256(folder / "plan.png"), original);
  for (const std::string file : {"plan.fixed.yaml", "plan.fixed.png", "plan.fixed.before_after.png"})
    EXPECT_TRUE(fs::exists(folder / file)) << file;
  EXPECT_GT(cv::imread(folder / "plan.fixed.before_after.png").cols, 600);
  const auto drive = rasterslam("simulate plan.fixed.yaml -o run.rawlog --duration 20", folder.path());
  EXPECT_EQ(drive.exit_code, 0) << drive.err;
  EXPECT_THAT(drive.out, HasSubstr(" 0 collisions"));

  const auto refused = rasterslam("world check plan.png --fix", folder.path());
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.err, HasSubstr("--overwrite"));
  EXPECT_EQ(rasterslam("world check plan.png --fix --overwrite", folder.path()).exit_code, 0);
  const auto nothing = rasterslam("world check plan.fixed.yaml --fix -o again.yaml", folder.path());
  EXPECT_EQ(nothing.exit_code, 0);
  EXPECT_FALSE(fs::exists(folder / "again.yaml"));
}

TEST(WorldCheck, NeverWritesOverThePlanItself) {
  const testing::TempFolder folder;
  drawPlan(folder);
  const std::string original = resources::fileSha256(folder / "plan.png");
  const auto result = rasterslam("world check plan.png --fix -o plan.yaml --overwrite", folder.path());
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("would replace the plan"));
  EXPECT_EQ(resources::fileSha256(folder / "plan.png"), original);
  // Nor the picture that a yaml names.
  std::ofstream(folder / "map.yaml") << "image: plan.png\nresolution: 0.025\norigin: [0, 0, 0]\n";
  const auto through_yaml = rasterslam("world check map.yaml --fix -o plan.yaml --overwrite", folder.path());
  EXPECT_EQ(through_yaml.exit_code, 3);
  EXPECT_EQ(resources::fileSha256(folder / "plan.png"), original);
}

TEST(WorldCheck, GivesItsFindingsAsJson) {
  const testing::TempFolder folder;
  drawPlan(folder);
  const auto result = rasterslam("world check plan.png --json --fix -o out.yaml", folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["kind"], "drawing");
  EXPECT_TRUE(json["usable"].get<bool>());
  bool has_doors = false;
  for (const auto& finding : json["findings"])
    if (finding["key"] == "doors") {
      has_doors = true;
      EXPECT_EQ(finding["count"], 7);
      EXPECT_EQ(finding["severity"], "warning");
      EXPECT_EQ(finding["places"].size(), 7u);
    }
  EXPECT_TRUE(has_doors);
  EXPECT_TRUE(json["fixed"]["findings"].empty());
  EXPECT_EQ(json["files"].size(), 3u);
}

TEST(WorldCheck, EndsWithThreeWhereThePlanCannotBeUsed) {
  const testing::TempFolder folder;
  cv::imwrite(folder / "white.png", cv::Mat(20, 30, CV_8U, cv::Scalar(255)));
  const auto white = rasterslam("world check white.png --fix", folder.path());
  EXPECT_EQ(white.exit_code, 3);
  EXPECT_THAT(white.out, HasSubstr("no wall at all"));
  EXPECT_FALSE(fs::exists(folder / "white.fixed.yaml"));
  EXPECT_EQ(rasterslam("world check none.png", folder.path()).exit_code, 3);
  EXPECT_EQ(rasterslam("world check flat --only dors").exit_code, 3);
  EXPECT_EQ(rasterslam("world check flat --robot-side -1").exit_code, 2);
  const auto huge_robot = rasterslam("world check flat --robot-side 9");
  EXPECT_EQ(huge_robot.exit_code, 3);
  EXPECT_THAT(huge_robot.out, HasSubstr("no place for a robot of side 9"));
  const auto out_of_range = rasterslam("world check flat --robot-side 1e9");
  EXPECT_EQ(out_of_range.exit_code, 3);
  EXPECT_THAT(out_of_range.err, HasSubstr("--robot-side"));
}

TEST(WorldCheck, NamesEveryKeyInItsHelp) {
  const auto help = rasterslam("world check --help");
  EXPECT_EQ(help.exit_code, 0);
  for (const std::string key :
       {"thresholds", "scale", "doors", "leaks", "text", "isolated", "open_edge", "Exit code"})
    EXPECT_THAT(help.out, HasSubstr(key));
}

}  // namespace
}  // namespace slam::apps
