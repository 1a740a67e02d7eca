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

namespace slam::check {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

const std::vector<std::string> kWorlds = {"corridor", "flat", "maze", "office_loop", "pillar_hall"};

/// Pictures in memory, checked as files.
class PlanChecks : public ::testing::Test {
 protected:
  std::string write(const cv::Mat& picture, const std::string& name = "plan.png") const {
    cv::imwrite(folder_ / name, picture);
    return folder_ / name;
  }
  /// A yaml beside a picture.
  std::string write(const cv::Mat& picture, double resolution_m,
                    const std::string& free_thresh = "0.196") const {
    write(picture);
    std::ofstream(folder_ / "plan.yaml")
        << "image: plan.png\nresolution: " << resolution_m
        << "\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: " << free_thresh << "\n";
    return folder_ / "plan.yaml";
  }
  static PlanCheckOptions only(std::vector<std::string> keys, double resolution_m = 0) {
    PlanCheckOptions options;
    options.only = std::move(keys);
    if (resolution_m > 0) options.resolution_m = resolution_m;
    return options;
  }
  static PlanCheckOptions at(double resolution_m) { return only({}, resolution_m); }
  /// The mended plan after one more look at it.
  PlanCheck again(const PlanCheck& check, PlanCheckOptions options) const {
    world::savePlan(check.after, folder_ / "again.yaml");
    options.resolution_m.reset();
    return checkPlan(folder_ / "again.yaml", options);
  }

  testing::TempFolder folder_;
};

/// Two rooms of 6 x 9 m side by side; an opening of `outer_px` in the left one's outer wall, one of 1.5 m
/// between them. 5 cm.
cv::Mat twoRooms(int outer_px) {
  cv::Mat picture(240, 320, CV_8U, cv::Scalar(255));
  cv::rectangle(picture, cv::Rect(30, 20, 250, 190), cv::Scalar(0), cv::FILLED);
  cv::rectangle(picture, cv::Rect(34, 24, 119, 182), cv::Scalar(255), cv::FILLED);
  cv::rectangle(picture, cv::Rect(157, 24, 119, 182), cv::Scalar(255), cv::FILLED);
  cv::rectangle(picture, cv::Rect(153, 60, 4, 30), cv::Scalar(255), cv::FILLED);
  if (outer_px > 0) cv::rectangle(picture, cv::Rect(30, 100, 4, outer_px), cv::Scalar(255), cv::FILLED);
  return picture;
}

const Finding* find(const PlanCheck& check, const std::string& key) {
  for (const Finding& finding : check.findings)
    if (finding.key == key) return &finding;
  return nullptr;
}
std::string keysOf(const PlanCheck& check) {
  std::string keys;
  for (const Finding& finding : check.findings) keys += (keys.empty() ? "" : " ") + finding.key;
  return keys;
}
/// 255 where the plan has such cells, as the picture lies.
cv::Mat maskOf(const world::Plan& plan, world::Cell cell) {
  cv::Mat mask(plan.rows, plan.columns, CV_8U);
  for (int row = 0; row < plan.rows; ++row)
    for (int column = 0; column < plan.columns; ++column)
      mask.at<std::uint8_t>(plan.rows - 1 - row, column) = plan.at(column, row) == cell ? 255 : 0;
  return mask;
}
int different(const cv::Mat& a, const cv::Mat& b) {
  return cv::countNonZero(a != b);
}
cv::Mat paper(int columns, int rows) {
  return {rows, columns, CV_8U, cv::Scalar(255)};
}
void box(cv::Mat& sheet, int x0, int y0, int x1, int y1, int gray, int thickness = cv::FILLED) {
  cv::rectangle(sheet, cv::Point(x0, y0), cv::Point(x1 - 1, y1 - 1), cv::Scalar(gray), thickness);
}
/// A room of 120 x 100 pixels in walls of 5 pixels on white paper, at 0.05 m a pixel 6 x 5 m.
cv::Mat roomOnPaper() {
  cv::Mat sheet = paper(200, 180);
  box(sheet, 35, 35, 165, 145, 0);
  box(sheet, 40, 40, 160, 140, 255);
  return sheet;
}
/// The middles of the architect's rooms that a disc of 0.283 m (the circle around the usual robot) reaches
/// from where it starts; clearances between cell centres, so half a cell on the safe side.
int roomsReached(const world::Plan& plan, const ArchitectPlan& drawn) {
  const auto start = world::findStartPose(plan, 0.283);
  if (!start) return 0;
  cv::Mat clearance, places;
  cv::distanceTransform(~maskOf(plan, world::Cell::kOccupied), clearance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  places = (clearance > 0.283 / plan.resolution_m + 0.5) & maskOf(plan, world::Cell::kFree);
  cv::Mat labels;
  cv::connectedComponents(places, labels, 4);
  const core::Point2 cell = world::worldToCells(plan, core::position(*start));
  const int home = labels.at<int>(plan.rows - 1 - static_cast<int>(cell.y), static_cast<int>(cell.x));
  int reached = 0;
  for (const auto& middle : ArchitectPlan::roomMiddles())
    reached += home > 0 && labels.at<int>(drawn.pixel(middle)) == home;
  return reached;
}

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

TEST_F(PlanChecks, ClosesGapsToTheOutsideUpToAWidth) {
  cv::Mat sheet = roomOnPaper();
  box(sheet, 90, 140, 108, 145, 255);  // 18 pixels, 0.9 m
  const PlanCheck check = checkPlan(write(sheet), at(0.05));
  ASSERT_TRUE(find(check, "leaks")) << keysOf(check);
  EXPECT_EQ(find(check, "leaks")->count, 1);
  EXPECT_THAT(find(check, "leaks")->text, HasSubstr("0.87 m"));
  EXPECT_NEAR(find(check, "leaks")->places[0].x, 99, 3);
  EXPECT_NEAR(find(check, "leaks")->places[0].y, 142, 4);
  EXPECT_EQ(maskOf(check.after, world::Cell::kFree).at<std::uint8_t>(0, 0), 0);
  EXPECT_EQ(maskOf(check.after, world::Cell::kFree).at<std::uint8_t>(100, 100), 255);
  // The room's floor is kept, but for the doorway.
  EXPECT_NEAR(cv::countNonZero(maskOf(check.after, world::Cell::kFree)), 120 * 100, 18 * 5);
  PlanCheckOptions narrower = at(0.05);
  narrower.widest_gap_m = 0.5;
  EXPECT_FALSE(find(checkPlan(write(sheet), narrower), "leaks"));
}

TEST_F(PlanChecks, BuildsAWallAroundABuildingThatIsOpen) {
  cv::Mat sheet = paper(300, 200);
  box(sheet, 60, 60, 65, 140, 0);
  box(sheet, 60, 60, 200, 65, 0);
  const PlanCheck check = checkPlan(write(sheet), at(0.05));
  ASSERT_TRUE(find(check, "outside"));
  EXPECT_THAT(find(check, "outside")->text, HasSubstr("no closed outline"));
  const cv::Mat free = maskOf(check.after, world::Cell::kFree);
  EXPECT_EQ(free.at<std::uint8_t>(0, 0), 0);
  EXPECT_EQ(free.at<std::uint8_t>(100, 100), 255);
  EXPECT_EQ(keysOf(again(check, {})), "");
}

TEST_F(PlanChecks, MakesThePaperAroundTheWallsUnknown) {
  cv::Mat sheet = roomOnPaper();
  cv::line(sheet, cv::Point(10, 20), cv::Point(100, 20), cv::Scalar(0));  // drawn outside, touching nothing
  const PlanCheck check = checkPlan(write(sheet), at(0.05));
  EXPECT_EQ(keysOf(check), "outside");
  EXPECT_EQ(find(check, "outside")->count, 1);
  EXPECT_EQ(different(maskOf(check.after, world::Cell::kOccupied), roomOnPaper() == 0), 0);
  EXPECT_EQ(cv::countNonZero(maskOf(check.after, world::Cell::kFree)), 120 * 100);
  EXPECT_EQ(keysOf(again(check, {})), "");
}

TEST_F(PlanChecks, TakesThePageFrameAwayButNoOuterWall) {
  ArchitectStyle style;
  style.doors = style.front_door = style.smooth = false;
  const PlanCheck framed = checkPlan(write(ArchitectPlan(style).sheet()), only({"border"}, 0.025));
  EXPECT_EQ(keysOf(framed), "border");
  style.page_border = false;
  EXPECT_EQ(keysOf(checkPlan(write(ArchitectPlan(style).sheet()), only({"border"}, 0.025))), "");
  cv::Mat hall = paper(400, 300);
  box(hall, 3, 3, 397, 297, 0, 2);
  for (int x = 60; x < 400; x += 60)
    for (int y = 60; y < 300; y += 60) box(hall, x, y, x + 8, y + 8, 0);
  EXPECT_EQ(keysOf(checkPlan(write(hall), only({"border"}, 0.05))), "");
}

TEST_F(PlanChecks, MakesRoomsWithoutAWayInUnknown) {
  cv::Mat sheet = roomOnPaper();
  sheet.setTo(205, sheet == 255);
  box(sheet, 40, 40, 160, 140, 255);
  box(sheet, 116, 40, 120, 140, 0);  // two rooms without a door
  box(sheet, 60, 60, 70, 70, 0);
  box(sheet, 63, 63, 67, 67, 255);  // a hollow pillar
  const std::string path = write(sheet, 0.05);
  const PlanCheck check = checkPlan(path, {});
  EXPECT_EQ(keysOf(check), "isolated isolated");
  EXPECT_EQ(check.findings[0].severity, Severity::kWarning);
  EXPECT_THAT(check.findings[0].text, HasSubstr("no way in"));
  EXPECT_EQ(check.findings[1].severity, Severity::kNote);
  const cv::Mat free = maskOf(check.after, world::Cell::kFree);
  EXPECT_EQ(free.at<std::uint8_t>(50, 130), 0);
  EXPECT_EQ(free.at<std::uint8_t>(65, 65), 0);
  EXPECT_EQ(free.at<std::uint8_t>(50, 50), 255);
  // A door of 8 pixels, 0.4 m: too narrow for a robot whose diagonal is 0.57 m, wide enough for one of 0.2 m.
  box(sheet, 116, 80, 120, 88, 255);
  const PlanCheck narrow = checkPlan(write(sheet, 0.05), {});
  EXPECT_THAT(narrow.findings.at(0).text, HasSubstr("too narrow"));
  PlanCheckOptions small;
  small.robot_side_m = 0.2;
  EXPECT_EQ(keysOf(checkPlan(path, small)), "isolated");
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
