// Scans of a lidar that turns while the robot does: told by [method] sweep_s, or by whoever has them.
#include <gtest/gtest.h>

#include <optional>

#include "libslam/core/numbers.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/mapping/scan_deskewer.h"
#include "tests/mapping/small_room.h"

namespace slam::mapping {
namespace {

/// driveThroughRoom() with exact odometry, each scan swept over the period before its stamp, or a share of
/// it.
test::Drive sweptDrive(double share = 1) {
  auto drive = test::driveThroughRoom();
  const auto walls = test::smallRoom();
  const core::Pose2 T_room_start{0, 0, -0.2};
  for (size_t i = 0; i < drive.entries.size(); ++i) {
    auto& entry = drive.entries[i];
    entry.T_previous_robot = i > 0 ? core::between(drive.truth[i - 1], drive.truth[i]) : core::Pose2{};
    const core::Pose2 T_robot_previous = core::inverse(entry.T_previous_robot);
    auto& ranges_m = entry.scan.ranges_m;
    for (size_t beam = 0; beam < ranges_m.size(); ++beam) {
      const double ago = 1 - static_cast<double>(beam) / static_cast<double>(ranges_m.size() - 1);
      const core::Pose2 T_room_then =
          T_room_start * drive.truth[i] * core::interpolate({}, T_robot_previous, share * ago);
      ranges_m[beam] = static_cast<float>(test::castRay(walls, T_room_then, entry.scan.angle(beam)));
    }
  }
  return drive;
}

struct Told {
  const char* method = "graph";
  double sweep_s = 0;
  bool deskew = true, has_odometry = true;
  std::optional<lidar::Sweep> by_the_log = {};
};

Told sweptBy(const char* method = "graph") {
  Told told;
  told.method = method, told.sweep_s = 0.2;
  return told;
}

double worstHeading(const Told& told, const test::Drive& drive, SweptScans* swept = nullptr) {
  files::IniFile config;
  config.set("method", "type", told.method, "test");
  config.set("method", "sweep_s", files::formatNumber(told.sweep_s), "test");
  config.set("method", "deskew", told.deskew ? "true" : "false", "test");
  auto method = makeMapBuilder(config, told.method, 1);
  double worst_rad = 0;
  for (size_t i = 0; i < drive.entries.size(); ++i) {
    const auto& entry = drive.entries[i];
    setSweep(method, told.by_the_log);
    const auto pose = processScan(method, entry.scan, entry.T_previous_robot, told.has_odometry);
    if (swept) *swept = sweptScans(method);
    worst_rad = std::max(worst_rad, std::abs(core::angleDifference(pose.phi, drive.truth[i].phi)));
  }
  return worst_rad;
}

TEST(Sweep, ScansAreDeskewedBeforeTheyAreMatched) {
  const auto drive = sweptDrive();
  const double as_they_are = worstHeading(Told(), drive), deskewed = worstHeading(sweptBy(), drive);
  // A sweep over 0.06 rad of turning turns the scan by half of that on the mean.
  EXPECT_GT(as_they_are, 0.015);
  EXPECT_LT(deskewed, 0.005);
}

TEST(Sweep, WhatOdometryErrsInALongOneIsFoundWithThePose) {
  auto drive = sweptDrive();
  // Wheels that turn too far and not far enough by turns: no scale sets that right.
  constexpr double kOff_rad = 0.04;
  for (size_t i = 1; i < drive.entries.size(); ++i)
    drive.entries[i].T_previous_robot.phi += i % 2 == 0 ? kOff_rad : -kOff_rad;
  // A scan that is deskewed by them is turned by half of that on the mean.
  EXPECT_LT(worstHeading(sweptBy("graph"), drive), 0.25 * kOff_rad);
  EXPECT_LT(worstHeading(sweptBy("particles"), drive), 0.4 * kOff_rad);
}

TEST(Sweep, WhatTheLogStatesIsEnough) {
  const auto drive = sweptDrive();
  Told told;
  told.by_the_log = lidar::Sweep{0.2};
  SweptScans swept;
  EXPECT_EQ(worstHeading(told, drive, &swept), worstHeading(sweptBy(), drive));
  EXPECT_EQ(swept.swept, drive.entries.size() - 1);
  EXPECT_EQ(swept.set_right, swept.swept);
}

TEST(Sweep, IsLeftWhereNobodyWantsItSetRight) {
  const auto drive = sweptDrive();
  Told told;
  told.by_the_log = lidar::Sweep{0.2};
  told.deskew = false;
  SweptScans swept;
  EXPECT_EQ(worstHeading(told, drive, &swept), worstHeading(Told(), drive));
  EXPECT_EQ(swept.swept, drive.entries.size() - 1);
  EXPECT_EQ(swept.set_right, 0U);
}

TEST(Sweep, WithoutOdometryScansStayAndAreCounted) {
  const auto drive = sweptDrive();
  Told told;
  told.method = "particles";
  told.has_odometry = false;
  const double as_they_are = worstHeading(told, drive);
  told.by_the_log = lidar::Sweep{0.2};
  SweptScans swept;
  // A motion that is itself from skewed scans would double the error.
  EXPECT_EQ(worstHeading(told, drive, &swept), as_they_are);
  EXPECT_EQ(swept.swept, drive.entries.size() - 1);
  EXPECT_EQ(swept.set_right, 0U);
}

TEST(Sweep, WithoutOdometryTheGraphFindsTheMotionWithThePose) {
  const auto drive = sweptDrive();
  Told told;
  told.has_odometry = false;
  const double as_they_are = worstHeading(told, drive);
  told.by_the_log = lidar::Sweep{0.2};
  SweptScans swept;
  EXPECT_LT(worstHeading(told, drive, &swept), 0.5 * as_they_are);
  EXPECT_EQ(swept.set_right, drive.entries.size() - 1);
}

/// How far a scan of sweptDrive() is from what the lidar would have seen at its stamp: the median over the
/// beams.
double skewOf(const lidar::Scan& scan, const core::Pose2& T_map_robot) {
  const auto walls = test::smallRoom();
  const core::Pose2 T_room_robot = core::Pose2{0, 0, -0.2} * T_map_robot;
  std::vector<double> off_m;
  for (size_t beam = 0; beam < scan.ranges_m.size(); ++beam)
    if (lidar::isReturn(scan.ranges_m[beam]))
      off_m.push_back(std::abs(scan.ranges_m[beam] - test::castRay(walls, T_room_robot, scan.angle(beam))));
  std::nth_element(off_m.begin(), off_m.begin() + static_cast<long>(off_m.size() / 2), off_m.end());
  return off_m[off_m.size() / 2];
}

/// Each scan of the drive deskewed, with odometry that is wrong by this heading, forth and back.
double meanSkew(double wrong_rad) {
  const auto drive = sweptDrive(0.25);
  MethodOptions options;
  options.sweep_s = 0.05;
  ScanDeskewer deskewer(options);
  StepHistory history;
  double sum_m = 0;
  for (size_t i = 0; i < drive.entries.size(); ++i) {
    const auto& entry = drive.entries[i];
    core::Pose2 T_previous_robot = entry.T_previous_robot;
    T_previous_robot.phi += i % 2 ? wrong_rad : -wrong_rad;
    const auto deskewed = deskewer.deskewed(history, entry.scan, {}, T_previous_robot, true);
    const lidar::Scan& scan = deskewed ? *deskewed : entry.scan;
    if (i > 0) sum_m += skewOf(scan, drive.truth[i]);
    history.note(scan, entry.T_previous_robot, drive.truth[i]);
    history.last_had_odometry = true;
  }
  return sum_m / static_cast<double>(drive.entries.size() - 1);
}

TEST(Sweep, WhatOdometryErrsSkewsNoScan) {
  const double exact_m = meanSkew(0);
  EXPECT_LT(exact_m, 0.002);
  EXPECT_LT(meanSkew(0.03), exact_m + 0.0004);
  // A wheel that slips.
  EXPECT_LT(meanSkew(0.12), exact_m + 0.0004);
  // So far that a match seldom leads back from there: the last motion goes on (without it: 12 mm).
  EXPECT_LT(meanSkew(0.2), exact_m + 0.002);
}

/// A scan whose sweep takes the whole period, in which a wheel slips by so much; the robot moved on evenly,
/// or it stood and begins to move.
struct AtSlip {
  double skew_m = core::kNaN;
  std::optional<core::Pose2> moved_instead;
  core::Pose2 T_true;
};
AtSlip atSlip(double slip_rad, bool has_stood) {
  const auto drive = sweptDrive();
  MethodOptions options;
  options.sweep_s = 0.2;
  ScanDeskewer deskewer(options);
  StepHistory history;
  constexpr size_t kAt = 5;
  for (size_t i = 0; i <= kAt; ++i) {
    const auto& entry = drive.entries[i];
    core::Pose2 T_previous_robot = entry.T_previous_robot;
    if (i == kAt) T_previous_robot.phi += slip_rad;
    if (i == kAt && has_stood) history.T_previous_last = {};
    const auto deskewed = deskewer.deskewed(history, entry.scan, {}, T_previous_robot, true);
    const lidar::Scan& scan = deskewed ? *deskewed : entry.scan;
    if (i == kAt) return {skewOf(scan, drive.truth[i]), deskewer.movedInstead(), entry.T_previous_robot};
    history.note(scan, entry.T_previous_robot, drive.truth[i]);
    history.last_had_odometry = true;
  }
  return {};
}

TEST(Sweep, AWheelThatSlipsSkewsNoScanThatTookTheWholePeriod) {
  const double exact_m = atSlip(0, false).skew_m;
  EXPECT_LT(exact_m, 0.005);
  for (const double slip_rad : {-0.5, -0.3, 0.3, 0.5}) {
    EXPECT_LT(atSlip(slip_rad, false).skew_m, exact_m + 0.003) << slip_rad;
    EXPECT_LT(atSlip(slip_rad, true).skew_m, exact_m + 0.01) << slip_rad;
  }
}

TEST(Sweep, TheMethodIsToldTheMotionThatTheScanShowsInstead) {
  for (const bool has_stood : {false, true}) {
    const auto at = atSlip(0.4, has_stood);
    ASSERT_TRUE(at.moved_instead.has_value()) << has_stood;
    EXPECT_NEAR(core::angleDifference(at.moved_instead->phi, at.T_true.phi), 0, 0.05) << has_stood;
    EXPECT_LT(core::distance(*at.moved_instead, at.T_true), 0.05) << has_stood;
  }
}

TEST(Sweep, OdometryIsBelievedWhereTheRobotBeginsToMove) {
  EXPECT_EQ(atSlip(0, true).skew_m, atSlip(0, false).skew_m);
  EXPECT_FALSE(atSlip(0, true).moved_instead.has_value());
}

}  // namespace
}  // namespace slam::mapping
