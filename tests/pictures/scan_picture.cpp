#include <gtest/gtest.h>

#include <string>

#include "libslam/pictures/picture.h"
#include "libslam/testing/temp_folder.h"
#include "tests/pictures/read_picture.h"

namespace slam::pictures {
namespace {

using testing::TempFolder;

TEST(DrawScan, LeavesAGapWhereABeamDidNotReturn) {
  const TempFolder folder;
  lidar::Scan scan;
  scan.first_angle_rad = -core::kPi / 2, scan.step_rad = core::kPi / 180, scan.max_range_m = 10;
  scan.ranges_m.assign(181, 4.0F);
  drawScan(scan, folder / "all.png");
  const int all = countOf(load(folder / "all.png"), draw::kBlue);
  for (size_t i = 60; i < 120; ++i) scan.ranges_m[i] = i % 2 ? lidar::kNoReturn : lidar::kLostReading;
  drawScan(scan, folder / "gap.png");
  const int gap = countOf(load(folder / "gap.png"), draw::kBlue);
  EXPECT_NEAR(double(gap) / all, 121.0 / 181, 0.05);  // dots overlap a little
}

TEST(DrawScan, SurvivesScansWithoutReturnsOrBeams) {
  const TempFolder folder;
  lidar::Scan scan;
  drawScan(scan, folder / "empty.png");
  scan.ranges_m = {2.5F};
  drawScan(scan, folder / "one.png");
  scan.step_rad = 0.1, scan.max_range_m = 5;
  scan.ranges_m.assign(10, lidar::kNoReturn);
  drawScan(scan, folder / "none.png");
  for (const std::string name : {"empty", "one", "none"}) load(folder / (name + ".png"));
}

}  // namespace
}  // namespace slam::pictures
