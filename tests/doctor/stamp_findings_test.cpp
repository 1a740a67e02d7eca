#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libslam/doctor/log_check.h"
#include "tests/doctor/drive.h"

namespace slam::doctor {
namespace {

using ::testing::HasSubstr;

TEST(LogCheck, FindsStampsThatRunBackRepeatOrPause) {
  Drive drive;
  drive.touch_scan = [](int number, mrpt::obs::CObservation2DRangeScan& scan) {
    if (number == 100) scan.timestamp -= std::chrono::seconds(2);
    if (number == 200) scan.timestamp -= std::chrono::milliseconds(200);
    return number < 250 || number >= 270;
  };
  const auto result = check(drive);
  EXPECT_THAT(
      said(result.findings, "backward"),
      HasSubstr("warning: CObservation2DRangeScan 'LASER': 1 of 280 stamps are earlier than the one before, "
                "by up to 1.800 s (at 1700000019.800)"));
  EXPECT_THAT(said(result.findings, "repeated"),
              HasSubstr("note: CObservation2DRangeScan 'LASER': 1 of 280 stamps equal the one before"));
  EXPECT_THAT(said(result.findings, "gaps"), HasSubstr("the longest 4.20 s after 1700000049.800"));
  EXPECT_EQ(said(healthy().findings, "backward") + said(healthy().findings, "repeated") +
                said(healthy().findings, "gaps") + said(healthy().findings, "order"),
            "");
}

TEST(LogCheck, AStreamsOwnStepBackIsSaidOnce) {
  Drive drive;
  drive.touch_scan = [](int number, mrpt::obs::CObservation2DRangeScan& scan) {
    if (number == 100) scan.timestamp -= std::chrono::seconds(2);
    return true;
  };
  const auto result = check(drive);
  EXPECT_EQ(result.figures.backward_in_file, 1U);
  EXPECT_THAT(said(result.findings, "backward"), HasSubstr("1 of 300 stamps"));
  EXPECT_EQ(said(result.findings, "order"), "");
}

TEST(LogCheck, FindsStreamsOutOfOrder) {
  Drive drive;
  drive.touch_scan = [](int, mrpt::obs::CObservation2DRangeScan& scan) {
    scan.timestamp -= std::chrono::milliseconds(50);
    return true;
  };
  const auto result = check(drive);
  EXPECT_EQ(result.figures.backward_in_file, 300U);
  EXPECT_THAT(said(result.findings, "order"), HasSubstr("note: 300 of 899 objects"));
  EXPECT_EQ(said(result.findings, "backward"), "");
}

TEST(LogCheck, LooksForScansWithoutStamps) {
  Drive drive;
  drive.scans = 40;
  drive.touch_scan = [](int number, mrpt::obs::CObservation2DRangeScan& scan) {
    if (number > 20) scan.timestamp = {};
    return true;
  };
  EXPECT_THAT(said(check(drive).findings, "unstamped"), HasSubstr("19 of 40 have no stamp"));
  EXPECT_EQ(said(healthy().findings, "unstamped"), "");
  drive.odometry_period_s = 0;
  drive.touch_scan = [](int, mrpt::obs::CObservation2DRangeScan& scan) {
    scan.timestamp = {};
    return true;
  };
  const auto result = check(drive);
  EXPECT_THAT(said(result.findings, "scans"), HasSubstr("error: 40 scans have no time stamp"));
  EXPECT_THAT(said(result.findings, "odometry"), HasSubstr("note: none"));
  EXPECT_FALSE(result.isUsable());
}

}  // namespace
}  // namespace slam::doctor
