#include "libslam/drafting/door_arcs.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "libslam/check/plan_check.h"
#include "libslam/testing/temp_folder.h"
#include "tests/check/architect_plan.h"

namespace slam::check {
namespace {

/// As a scanner leaves a sheet: grey paper, walls that are not black, lines smoothed over two pixels, noise.
cv::Mat scanned(const cv::Mat& sheet, double smoothing_px) {
  cv::Mat scan, noise(sheet.size(), CV_32F);
  sheet.convertTo(scan, CV_32F, 180.0 / 255, 68);
  cv::GaussianBlur(scan, scan, {}, smoothing_px);
  cv::RNG random(3);
  random.fill(noise, cv::RNG::NORMAL, 0, 4);
  scan += noise;
  scan.convertTo(scan, CV_8U);
  return scan;
}

TEST(DoorArcs, AreFoundInAScanWhoseThinLinesAreTooPaleForWalls) {
  for (const double smoothing_px : {0.8, 1.0, 1.2}) {
    ArchitectStyle style;
    style.page_border = style.dimensions = style.room_names = false;
    const testing::TempFolder folder;
    const std::string path = folder / "scan.png";
    ASSERT_TRUE(cv::imwrite(path, scanned(ArchitectPlan(style).sheet(), smoothing_px)));
    PlanCheckOptions options;
    options.resolution_m = 1 / style.pixels_per_metre;
    const PlanCheck check = checkPlan(path, options);
    int doors = 0;
    for (const auto& finding : check.findings)
      if (finding.key == "doors") doors = finding.count;
    EXPECT_GE(doors, 6) << smoothing_px;  // of 7, the one to the outside among them
    EXPECT_LT(check.hidden_share, 0.2) << smoothing_px;
    // The flat's 10 x 7.5 m without its inner walls, as a robot can cover them.
    EXPECT_GT(check.figures.reachable_m2, 0.8 * 10 * 7.5) << smoothing_px;
  }
}

TEST(DoorArcs, AreAddedWhereTheyAreOthersOfTheUsualSize) {
  const drafting::DoorArc door{{50, 50}, 20, CV_PI / 2, 0};
  drafting::DoorArc same = door, large = door, other = door;
  same.hinge.x += 2;
  large.hinge.y += 80, large.radius = 26;
  other.hinge.x += 40, other.opening_rad = CV_PI;  // the other leaf of a broad doorway
  std::vector<drafting::DoorArc> doors = {door};
  drafting::addDoorArcs(doors, {same, large, other});
  ASSERT_EQ(doors.size(), 2U);
  EXPECT_EQ(doors[0].hinge.x, 50);
  EXPECT_EQ(doors[1].hinge.x, 90);
}

}  // namespace
}  // namespace slam::check
