#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "libslam/files/files.h"
#include "tests/apps/program.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// A room of `columns` x 40 cells of 5 cm with walls all round.
void writeRoom(const std::string& path, int columns = 60) {
  cv::Mat picture(40, columns, CV_8UC1, cv::Scalar(255));
  for (cv::Mat wall : {picture.row(0), picture.row(39), picture.col(0), picture.col(columns - 1)})
    wall.setTo(0);
  cv::imwrite(path, picture);
}

TEST(Navigate, DrivesToTheGoalAndWritesAFolder) {
  const testing::TempFolder folder;
  writeRoom(folder / "room.png");
  const auto result = rasterslam(
      "navigate room.png --start '0.6 1 0' --goal '2.3 1.2' --method tangent,lidar_bug --json -q -o out",
      folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto table = nlohmann::json::parse(result.out);
  ASSERT_EQ(table["rows"].size(), 2U);
  for (const auto& row : table["rows"]) {
    EXPECT_EQ(row["result"], "reached");
    EXPECT_EQ(row["collisions"], 0);
    EXPECT_LT(row["goal_distance_m"].get<double>(), 0.2);
  }
  for (const std::string name : {"tangent/states.csv", "lidar_bug/path.png", "paths.png", "manifest.json"})
    EXPECT_TRUE(fs::exists(folder / ("out/" + name))) << name;
  EXPECT_EQ(rasterslam("navigate room.png --goal '2.3 1.2' -q -o out", folder.path()).exit_code, 3);
}

TEST(Navigate, IsDoneAtOnceWhereTheGoalIsTheStart) {
  const testing::TempFolder folder;
  writeRoom(folder / "room.png");
  const auto result = rasterslam("navigate room.png --start '1 1 0' --goal '1 1' -o out", folder.path());
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("reached"));
}

TEST(Navigate, AnswersWithFourWhenTheGoalIsNotReached) {
  const testing::TempFolder folder;
  writeRoom(folder / "room.png");
  const auto result = rasterslam(
      "navigate room.png --start '0.6 1 0' --goal '2.3 1.2' --method bug2 --set navigate.time_limit_s=1 "
      "-o out",
      folder.path());
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.out, HasSubstr("gave up"));
  EXPECT_THAT(result.out, HasSubstr("time limit of 1 s"));
}

TEST(Navigate, EndsWhereThePlanIsOpenAndWhereNothingReturns) {
  const testing::TempFolder folder;
  cv::Mat open(60, 60, CV_8UC1, cv::Scalar(255));
  open.at<unsigned char>(59, 0) = 0;  // a plan needs a wall somewhere
  cv::imwrite(folder / "open.png", open);
  const auto reached = rasterslam(
      "navigate open.png --start '1 1.5 0' --goal '2.4 2.4' --method bug1,bug2,tangent -o a", folder.path());
  EXPECT_EQ(reached.exit_code, 0) << reached.out;
  // Readings that are all lost, whatever stands there.
  const auto blind = rasterslam(
      "navigate open.png --start '1 1.5 0' --goal '2.4 2.4' --set lidar.drop_out=1 -o b", folder.path());
  EXPECT_EQ(blind.exit_code, 4);
  EXPECT_THAT(blind.out, HasSubstr("no valid reading"));
}

TEST(Navigate, RefusesBadInputInOneLine) {
  const testing::TempFolder folder;
  writeRoom(folder / "room.png");
  writeRoom(folder / "shaft.png", 12);
  const auto expectRefusal = [&](const std::string& arguments, const std::string& what) {
    const auto result = rasterslam("navigate " + arguments, folder.path());
    EXPECT_EQ(result.exit_code, 3) << arguments << "\n" << result.err;
    EXPECT_THAT(result.err, HasSubstr(what)) << arguments;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_FALSE(fs::exists(folder / "navigation")) << arguments;
    EXPECT_THAT(testing::leftoversIn(folder.path()), ::testing::IsEmpty()) << arguments;
  };
  expectRefusal("none.png --goal '1 1'", "none.png: no such file");
  expectRefusal("room.png --goal '1'", "--goal: found '1', expected two numbers: x_m,y_m");
  expectRefusal("room.png --goal 'here'", "--goal: found 'here'");
  expectRefusal("room.png --goal '1 1' --start '1 1'", "--start: found '1 1', expected three numbers");
  expectRefusal("room.png --goal '9 9'", "goal (9.000 m, 9.000 m) is outside the plan");
  expectRefusal("room.png --goal '0.01 1'", "is in a wall");
  expectRefusal("room.png --goal '1 1' --start '0.01 1 0'", "start pose (0.010 m, 1.000 m, 0.0 deg) is");
  expectRefusal("room.png --goal '1 1' --start '-3 1 0'", "outside the plan");
  expectRefusal("shaft.png --goal '0.3 1'", "no free place for a robot of side 0.4 m");
  expectRefusal("room.png --goal '1 1' --method bug7", "did you mean 'bug1'?");
  expectRefusal("room.png --goal '1 1' --slam ipc", "'ipc'");
  expectRefusal("room.png --goal '1 1' --set navigate.clearence_m=1", "did you mean 'clearance_m'?");
  expectRefusal("room.png --goal '1 1' --set navigate.turn=up", "found 'up'");
  expectRefusal("room.png --goal '1 1' --set strategy.name=quadrant", "strategy");
  EXPECT_EQ(rasterslam("navigate room.png", folder.path()).exit_code, 2);
}

}  // namespace
}  // namespace slam::apps
