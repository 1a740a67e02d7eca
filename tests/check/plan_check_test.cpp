#include "libslam/check/plan_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"
#include "tests/check/architect_plan.h"
#include "tests/check/checked_pictures.h"

namespace slam::check {
namespace {
using ::testing::HasSubstr;

const std::vector<std::string> kWorlds = {"corridor", "flat", "maze", "office_loop", "pillar_hall"};

TEST_F(PlanChecks, FindsNothingInTheCommittedWorlds) {
  for (const auto& name : kWorlds) {
    const PlanCheck check = checkPlan(RASTERSLAM_SOURCE_DIR "/datasets/worlds/" + name + ".yaml", {});
    EXPECT_EQ(keysOf(check), "") << name;
    EXPECT_FALSE(check.isMendable()) << name;
    EXPECT_TRUE(check.before.cells == check.after.cells) << name;
    EXPECT_EQ(check.before.resolution_m, check.after.resolution_m) << name;
    EXPECT_TRUE(check.is_map) << name;
  }
}

TEST_F(PlanChecks, SaysTheSizesOfAPlan) {
  const PlanCheck flat = checkPlan(RASTERSLAM_SOURCE_DIR "/datasets/worlds/flat.yaml", {});
  // Measured on the picture: walls 252 x 190 cells; doors of 18 and 20 cells of 0.05 m, read to half a cell.
  EXPECT_NEAR(flat.figures.width_m, 12.6, 1e-9);
  EXPECT_NEAR(flat.figures.height_m, 9.5, 1e-9);
  EXPECT_NEAR(flat.figures.free_m2, 86.6, 0.1);
  EXPECT_GE(flat.figures.rooms, 5);
  ASSERT_FALSE(flat.figures.door_widths_m.empty());
  EXPECT_NEAR(flat.figures.door_widths_m.front(), 0.9, 0.05);
}

TEST_F(PlanChecks, SaysThatAPictureWithoutYamlHasNoScaleAndThatTheGivenOneWins) {
  const std::string path = write(roomOnPaper());
  const PlanCheck assumed = checkPlan(path, only({"scale"}));
  ASSERT_TRUE(find(assumed, "scale"));
  EXPECT_EQ(find(assumed, "scale")->severity, Severity::kWarning);
  EXPECT_THAT(find(assumed, "scale")->text, HasSubstr("0.05 m a pixel is assumed"));
  EXPECT_TRUE(assumed.isMendable());
  EXPECT_EQ(assumed.after.resolution_m, 0.05);
  const PlanCheck given = checkPlan(path, only({"scale"}, 0.02));
  EXPECT_EQ(keysOf(given), "");
  EXPECT_EQ(given.after.resolution_m, 0.02);
}

TEST_F(PlanChecks, EstimatesTheScaleFromDoorLeaves) {
  ArchitectStyle style;
  for (const double pixels_per_metre : {32.0, 60.0}) {
    style.pixels_per_metre = pixels_per_metre;
    const PlanCheck check = checkPlan(write(ArchitectPlan(style).sheet()), only({"thresholds", "scale"}));
    // The leaves are 0.9 m, 0.85 is assumed, and their radius is found to 2 pixels.
    EXPECT_NEAR(check.after.resolution_m * pixels_per_metre, 1, 0.15) << pixels_per_metre;
    EXPECT_THAT(find(check, "scale")->text, HasSubstr("door leaves"));
  }
  style.pixels_per_metre = 20;
  const PlanCheck plausible = checkPlan(write(ArchitectPlan(style).sheet()), only({"thresholds", "scale"}));
  EXPECT_EQ(plausible.after.resolution_m, 0.05);
  EXPECT_THAT(find(plausible, "scale")->text, HasSubstr("plausible"));
}

TEST_F(PlanChecks, CallsAScaleImplausibleWhenDoorsOrBuildingsWouldBeAbsurd) {
  ArchitectStyle style;
  const std::string path = write(ArchitectPlan(style).sheet());
  const PlanCheck tiny_doors = checkPlan(path, only({"thresholds", "scale"}, 0.005));
  ASSERT_TRUE(find(tiny_doors, "scale"));
  EXPECT_FALSE(tiny_doors.isUsable());
  EXPECT_EQ(tiny_doors.after.resolution_m, 0.005);
  EXPECT_THAT(find(tiny_doors, "scale")->remedy, HasSubstr("give --resolution"));
  const PlanCheck huge = checkPlan(write(roomOnPaper()), only({"scale"}, 20));
  EXPECT_FALSE(huge.isUsable());
  EXPECT_THAT(find(huge, "scale")->text, HasSubstr("2600 m"));
}

TEST_F(PlanChecks, ReadsPaleSmoothLinesAsWholeWalls) {
  // A turned square of thin smooth lines: with the usual thresholds it is open in many places.
  cv::Mat sheet = paper(200, 200);
  const std::vector<cv::Point> corners = {{100, 20}, {180, 95}, {105, 180}, {20, 90}};
  cv::polylines(sheet, corners, true, cv::Scalar(60), 1, cv::LINE_AA);
  const PlanCheck check = checkPlan(write(sheet), only({"thresholds"}, 0.05));
  ASSERT_TRUE(find(check, "thresholds"));
  const auto insideIsOpen = [](const world::Plan& plan) {
    cv::Mat free = ~maskOf(plan, world::Cell::kOccupied), labels;
    cv::connectedComponents(free, labels, 4);
    return labels.at<int>(0, 0) == labels.at<int>(100, 100);
  };
  EXPECT_TRUE(insideIsOpen(check.before));
  EXPECT_FALSE(insideIsOpen(check.after));
  // Nothing grows: no wall pixel is farther than the smoothing reaches.
  cv::Mat drawn = sheet < 255;
  EXPECT_EQ(cv::countNonZero(maskOf(check.after, world::Cell::kOccupied) & ~drawn), 0);
}

TEST_F(PlanChecks, NeitherOpensNorClosesGapsOfAPixelWhenItReadsGray) {
  cv::Mat sheet = paper(60, 60);
  box(sheet, 10, 30, 50, 31, 0);
  box(sheet, 30, 30, 31, 31, 255);  // a gap of one pixel
  box(sheet, 10, 40, 50, 41, 90);   // pale
  const PlanCheck check = checkPlan(write(sheet), only({"thresholds"}, 0.05));
  const cv::Mat walls = maskOf(check.after, world::Cell::kOccupied);
  EXPECT_EQ(cv::countNonZero(walls), 39 + 40);
  EXPECT_EQ(walls.at<std::uint8_t>(30, 30), 0);
}

TEST_F(PlanChecks, ReadsAnUnevenlyLitPhotographAndAJpeg) {
  const ArchitectPlan plan{ArchitectStyle{}};
  cv::Mat dim(plan.sheet().size(), CV_8U);
  for (int y = 0; y < dim.rows; ++y)
    for (int x = 0; x < dim.cols; ++x)
      dim.at<std::uint8_t>(y, x) =
          static_cast<std::uint8_t>(plan.sheet().at<std::uint8_t>(y, x) * (0.95 - 0.45 * x / dim.cols));
  const cv::Mat walls =
      maskOf(checkPlan(write(plan.sheet()), only({"thresholds"}, 0.025)).after, world::Cell::kOccupied);
  for (const std::string name : {"dim.png", "dim.jpg"}) {
    const PlanCheck check = checkPlan(write(dim, name), only({"thresholds"}, 0.025));
    const cv::Mat found = maskOf(check.after, world::Cell::kOccupied);
    // The smoothed rims of lines shift a little with the light: a few percent of the ink.
    EXPECT_LT(different(found, walls), 0.06 * cv::countNonZero(walls)) << name;
    EXPECT_THAT(find(check, "thresholds")->text, HasSubstr("unevenly")) << name;
  }
}

TEST_F(PlanChecks, SaysWhichColoursCountAsWall) {
  cv::Mat sheet(40, 60, CV_8UC3, cv::Scalar(255, 255, 255));
  cv::rectangle(sheet, {5, 5, 50, 30}, cv::Scalar(120, 0, 0), 3);                 // dark blue, in BGR
  cv::rectangle(sheet, {20, 15, 10, 10}, cv::Scalar(190, 255, 255), cv::FILLED);  // pale yellow
  const PlanCheck check = checkPlan(write(sheet), only({"colours"}, 0.05));
  ASSERT_TRUE(find(check, "colours"));
  EXPECT_THAT(find(check, "colours")->text, HasSubstr("blue counts as wall"));
  EXPECT_THAT(find(check, "colours")->text, HasSubstr("yellow counts as free"));
  EXPECT_FALSE(check.isMendable());
  cv::Mat gray;
  cv::cvtColor(roomOnPaper(), gray, cv::COLOR_GRAY2BGR);
  EXPECT_EQ(keysOf(checkPlan(write(gray), only({"colours"}))), "");
}

TEST_F(PlanChecks, TakesTextAwayAndKeepsTheWallsToThePixel) {
  for (const bool filled : {true, false}) {
    ArchitectStyle style;
    style.page_border = style.dimensions = style.doors = style.furniture = style.smooth = false;
    style.filled_walls = filled;
    style.room_names = false;
    const cv::Mat walls = ArchitectPlan(style).sheet() == 0;
    style.room_names = true;
    const PlanCheck check = checkPlan(write(ArchitectPlan(style).sheet()), only({"text"}, 0.025));
    ASSERT_TRUE(find(check, "text"));
    EXPECT_EQ(find(check, "text")->count, 7);
    EXPECT_EQ(different(maskOf(check.after, world::Cell::kOccupied), walls), 0);
  }
}

TEST_F(PlanChecks, TakesNoPillarChairOrTableForText) {
  cv::Mat sheet = paper(400, 300);
  box(sheet, 5, 5, 395, 295, 0, 4);
  for (int i = 0; i < 12; ++i) {
    box(sheet, 40 + 26 * i, 40, 50 + 26 * i, 50, 0);                      // pillars
    box(sheet, 40 + 14 * i, 80, 50 + 14 * i, 90, 0, 1);                   // a row of chairs
    cv::circle(sheet, cv::Point(45 + 16 * i, 120), 6, cv::Scalar(0), 1);  // round stools
    cv::line(sheet, cv::Point(40 + 5 * i, 150), cv::Point(40 + 5 * i, 175), cv::Scalar(0));  // stairs
    const std::vector<cv::Point> shell = {
        {40 + 14 * i, 200}, {40 + 14 * i, 210}, {50 + 14 * i, 210}, {50 + 14 * i, 200}};
    cv::polylines(sheet, shell, false, cv::Scalar(0));  // seats, open to one side
  }
  const PlanCheck check = checkPlan(write(sheet), only({"text", "dimensions", "doors", "border"}, 0.05));
  EXPECT_EQ(keysOf(check), "");
  EXPECT_TRUE(check.before.cells == check.after.cells);
}

TEST_F(PlanChecks, TakesDimensionLinesAwayAndLeavesWhatTheyCrossWhole) {
  ArchitectStyle style;
  style.page_border = style.doors = style.furniture = style.smooth = style.dimensions = style.room_names =
      false;
  const cv::Mat walls = ArchitectPlan(style).sheet() == 0;
  style.dimensions = true;
  const PlanCheck check = checkPlan(write(ArchitectPlan(style).sheet()), only({"dimensions", "text"}, 0.025));
  ASSERT_TRUE(find(check, "dimensions"));
  EXPECT_GE(find(check, "dimensions")->count, 2);
  const cv::Mat left = maskOf(check.after, world::Cell::kOccupied);
  EXPECT_EQ(cv::countNonZero(walls & ~left), 0);
  // Within the walls nothing is left of them; outside the one without a figure may be.
  const cv::Rect inside(80, 80, 400, 300);
  EXPECT_EQ(different(left(inside), walls(inside)), 0);
}

TEST_F(PlanChecks, OpensDoorsSoThatTheRobotReachesEveryRoom) {
  for (const bool filled : {true, false})
    for (const double pixels_per_metre : {20.0, 40.0, 64.0}) {
      ArchitectStyle style;
      style.page_border = style.dimensions = style.room_names = false;
      style.filled_walls = filled;
      style.pixels_per_metre = pixels_per_metre;
      const ArchitectPlan plan(style);
      const PlanCheckOptions options = at(1 / pixels_per_metre);
      const PlanCheck check = checkPlan(write(plan.sheet()), options);
      ASSERT_TRUE(find(check, "doors")) << pixels_per_metre;
      EXPECT_EQ(find(check, "doors")->count, 7) << pixels_per_metre << (filled ? " filled" : " lines");
      EXPECT_EQ(roomsReached(check.after, plan), 6) << pixels_per_metre << (filled ? " filled" : " lines");
      EXPECT_EQ(keysOf(again(check, options)), "");
    }
}

TEST_F(PlanChecks, TakesNoRoundTableOrColumnForADoor) {
  cv::Mat sheet = paper(300, 300);
  box(sheet, 10, 10, 290, 290, 0, 5);
  cv::circle(sheet, cv::Point(80, 80), 30, cv::Scalar(0), 1);
  cv::circle(sheet, cv::Point(200, 80), 18, cv::Scalar(0), cv::FILLED);
  cv::ellipse(sheet, cv::Point(290, 290), cv::Size(80, 80), 0, 180, 270, cv::Scalar(0),
              2);  // a shower's wall
  const PlanCheck check = checkPlan(write(sheet), only({"doors"}, 0.05));
  EXPECT_EQ(keysOf(check), "");
}

TEST_F(PlanChecks, ClearsARobotsMapOfRaysAndSpecksAndWallsItsEdge) {
  cv::Mat sheet(160, 200, CV_8U, cv::Scalar(205));
  box(sheet, 35, 35, 125, 125, 0);
  box(sheet, 40, 40, 120, 120, 254);
  box(sheet, 120, 60, 125, 100, 205);                                           // an open side of 40 pixels
  cv::line(sheet, cv::Point(100, 80), cv::Point(199, 60), cv::Scalar(254), 2);  // rays through it
  cv::line(sheet, cv::Point(100, 80), cv::Point(199, 110), cv::Scalar(254), 2);
  sheet.at<std::uint8_t>(60, 60) = 205;
  const PlanCheck check = checkPlan(write(sheet, 0.05), {});
  EXPECT_EQ(keysOf(check), "specks rays open_edge");
  const cv::Mat free = maskOf(check.after, world::Cell::kFree);
  EXPECT_EQ(free.at<std::uint8_t>(60, 190), 0);
  EXPECT_EQ(free.at<std::uint8_t>(60, 60), 255);
  // Sealed: no free cell has an unknown neighbour, corners included.
  cv::Mat around;
  cv::dilate(free, around, cv::Mat::ones(3, 3, CV_8U));
  EXPECT_EQ(cv::countNonZero(around & maskOf(check.after, world::Cell::kUnknown)), 0);
  EXPECT_NEAR(cv::countNonZero(free), 80 * 80, 40);
  EXPECT_EQ(keysOf(again(check, {})), "");
}

TEST_F(PlanChecks, SaysThatTheUsualGrayOfTheUnknownCountsAsFree) {
  cv::Mat sheet = roomOnPaper();
  box(sheet, 0, 0, 200, 35, 205), box(sheet, 0, 145, 200, 180, 205);
  box(sheet, 0, 0, 35, 180, 205), box(sheet, 165, 0, 200, 180, 205);
  EXPECT_EQ(keysOf(checkPlan(write(sheet, 0.05), {})), "");
  const PlanCheck check = checkPlan(write(sheet, 0.05, "0.25"), {});
  EXPECT_EQ(keysOf(check), "thresholds");
  EXPECT_THAT(find(check, "thresholds")->text, HasSubstr("free_thresh 0.25"));
  EXPECT_EQ(cv::countNonZero(maskOf(check.after, world::Cell::kFree)), 120 * 100);
}

TEST_F(PlanChecks, CallsWhatHoldsNoRobotUnusable) {
  EXPECT_THAT(find(checkPlan(write(paper(1, 1)), {}), "size")->text, HasSubstr("a single pixel"));
  EXPECT_THAT(find(checkPlan(write(paper(30, 20)), {}), "size")->text,
              HasSubstr("no wall at all in 30 x 20"));
  const cv::Mat black(20, 30, CV_8U, cv::Scalar(0));
  EXPECT_THAT(find(checkPlan(write(black), {}), "size")->text, HasSubstr("no free space"));
  for (const cv::Mat& picture : {paper(1, 1), paper(30, 20), black}) {
    const PlanCheck check = checkPlan(write(picture), {});
    EXPECT_FALSE(check.isUsable());
    EXPECT_FALSE(check.isMendable());
  }
  const PlanCheck cramped = checkPlan(write(roomOnPaper()), at(0.002));
  EXPECT_FALSE(cramped.isUsable());
  EXPECT_TRUE(find(cramped, "start"));
}

TEST_F(PlanChecks, MendsAWholeArchitectsPlanAtOnceAndOnlyOnce) {
  for (const bool filled : {true, false})
    for (const double pixels_per_metre : {40.0, 80.0}) {
      ArchitectStyle style;
      style.filled_walls = filled;
      style.pixels_per_metre = pixels_per_metre;
      const ArchitectPlan plan(style);
      const PlanCheck check = checkPlan(write(plan.sheet()), {});
      EXPECT_TRUE(check.isUsable());
      for (const std::string key :
           {"thresholds", "border", "scale", "dimensions", "doors", "text", "leaks", "outside"})
        EXPECT_TRUE(find(check, key)) << key << " at " << pixels_per_metre;
      EXPECT_EQ(roomsReached(check.after, plan), 6) << pixels_per_metre << (filled ? " filled" : " lines");
      const PlanCheck twice = again(check, {});
      EXPECT_EQ(keysOf(twice), "");
      EXPECT_TRUE(twice.after.cells == check.after.cells);
    }
}

TEST_F(PlanChecks, LooksOnlyForWhatIsAskedFor) {
  const std::string path = write(ArchitectPlan(ArchitectStyle{}).sheet());
  EXPECT_EQ(keysOf(checkPlan(path, only({"border", "scale"}))), "border scale");
  PlanCheckOptions options;
  for (const auto& [key, meaning] : planCheckKeys()) options.skip.push_back(key);
  const PlanCheck nothing = checkPlan(path, options);
  EXPECT_EQ(keysOf(nothing), "");
  EXPECT_TRUE(nothing.before.cells == nothing.after.cells);
  EXPECT_EQ(testing::errorOf([&] { checkPlan(path, only({"txt"})); }),
            "--only: found 'txt', expected one of the keys of 'world check --help'; did you mean 'text'?");
}

TEST_F(PlanChecks, MendsRealMapsOnceAndLeavesTheirWallsStanding) {
  const std::string data = testing::realDataFolder(RASTERSLAM_SOURCE_DIR);
  if (data.empty()) GTEST_SKIP() << "no real data";
  for (const std::string name : {"turtlebot3/map", "nav2/depot", "willow/willow-full"}) {
    const PlanCheck check = checkPlan(data + "/worlds/" + name + ".yaml", {});
    EXPECT_TRUE(check.is_map) << name;
    EXPECT_TRUE(check.isUsable()) << name;
    const cv::Mat walls = maskOf(check.before, world::Cell::kOccupied);
    EXPECT_EQ(cv::countNonZero(walls & ~maskOf(check.after, world::Cell::kOccupied)), 0) << name;
    const PlanCheck twice = again(check, {});
    EXPECT_EQ(keysOf(twice), "") << name;
  }
}

TEST_F(PlanChecks, SurvivesAnyPicture) {
  core::RandomStream random(7, "pictures");
  const auto below = [&](int limit) { return static_cast<int>(random.uniform() * limit); };
  for (int i = 0; i < 100; ++i) {
    cv::Mat picture(1 + below(64), 1 + below(64), CV_8U, cv::Scalar(below(2) * 255));
    const int kind = below(3);
    for (int y = 0; y < picture.rows; ++y)
      for (int x = 0; x < picture.cols; ++x)
        if (kind == 0)
          picture.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(below(256));
        else if (kind == 1)
          picture.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(below(8) == 0   ? 0
                                                                     : below(3) == 0 ? 205
                                                                                     : 254);
    for (int k = below(12); k > 0; --k)
      cv::line(picture, {below(64), below(64)}, {below(64), below(64)}, cv::Scalar(below(256)), 1 + below(3));
    const PlanCheckOptions options = below(2) ? at(0.01 + random.uniform()) : PlanCheckOptions();
    const PlanCheck check = checkPlan(write(picture), options);
    EXPECT_EQ(check.after.cells.size(), check.before.cells.size());
    EXPECT_EQ(check.changes.size(), check.before.cells.size());
    for (const Finding& finding : check.findings)
      EXPECT_FALSE(finding.text.empty() || finding.remedy.empty());
  }
}

TEST_F(PlanChecks, SayHowMuchOfThePlanMendingTakesForTheOutside) {
  const auto closed = checkPlan(write(twoRooms(30)), at(0.05));  // 1.5 m: closed
  EXPECT_LT(closed.hidden_share, 0.01);
  // 3 m stay open, so that the passage between the rooms is what is closed, and one room of two is lost.
  const auto open = checkPlan(write(twoRooms(60)), at(0.05));
  EXPECT_NEAR(open.hidden_share, 0.5, 0.05);
  EXPECT_NEAR(open.hidden_m2, 119 * 182 * 0.0025, 3);
  const auto whole = checkPlan(write(twoRooms(0)), at(0.05));
  EXPECT_EQ(whole.hidden_m2, 0) << "the paper around does not count";
}

}  // namespace
}  // namespace slam::check
