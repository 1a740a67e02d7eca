// What lies round a building and round its page, and rooms that nobody comes into.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/check/checked_pictures.h"

namespace slam::check {
namespace {
using ::testing::HasSubstr;

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

}  // namespace
}  // namespace slam::check
