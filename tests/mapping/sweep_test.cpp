// Scans of a lidar that turns while the robot does: told by [method] sweep_s, or by whoever has them.
#include <gtest/gtest.h>

#include "libslam/mapping/map_builder.h"
#include "tests/mapping/small_room.h"

namespace slam::mapping {
namespace {

/// driveThroughRoom() with exact odometry, each scan swept over the whole period before its stamp.
test::Drive sweptDrive() {
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
          T_room_start * drive.truth[i] * core::interpolate({}, T_robot_previous, ago);
      ranges_m[beam] = static_cast<float>(test::castRay(walls, T_room_then, entry.scan.angle(beam)));
    }
  }
  return drive;
}

struct Told {
  double sweep_s = 0;
  bool deskew = true, has_odometry = true;
  std::optional<robot::Sweep> by_the_log = {};
};

double worstHeading(const Told& told, const test::Drive& drive, SweptScans* swept = nullptr) {
  core::IniFile config;
  config.set("method", "type", "graph", "test");
  config.set("method", "sweep_s", core::formatNumber(told.sweep_s), "test");
  config.set("method", "deskew", told.deskew ? "true" : "false", "test");
  auto method = makeMapBuilder(config, "graph", 1);
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
  const double as_they_are = worstHeading({}, drive), deskewed = worstHeading({0.2}, drive);
  // A sweep over 0.06 rad of turning turns the scan by half of that on the mean.
  EXPECT_GT(as_they_are, 0.015);
  EXPECT_LT(deskewed, 0.005);
}

TEST(Sweep, WhatTheLogStatesIsEnough) {
  const auto drive = sweptDrive();
  Told told;
  told.by_the_log = robot::Sweep{0.2};
  SweptScans swept;
  EXPECT_EQ(worstHeading(told, drive, &swept), worstHeading({0.2}, drive));
  EXPECT_EQ(swept.swept, drive.entries.size() - 1);
  EXPECT_EQ(swept.set_right, swept.swept);
}

TEST(Sweep, IsLeftWhereNobodyWantsItSetRight) {
  const auto drive = sweptDrive();
  Told told;
  told.by_the_log = robot::Sweep{0.2};
  told.deskew = false;
  SweptScans swept;
  EXPECT_EQ(worstHeading(told, drive, &swept), worstHeading({}, drive));
  EXPECT_EQ(swept.swept, drive.entries.size() - 1);
  EXPECT_EQ(swept.set_right, 0U);
}

TEST(Sweep, WithoutOdometryTheScansStayAndAreCounted) {
  const auto drive = sweptDrive();
  Told told;
  told.has_odometry = false;
  const double as_they_are = worstHeading(told, drive);
  told.by_the_log = robot::Sweep{0.2};
  SweptScans swept;
  // A motion that is itself from skewed scans would double the error.
  EXPECT_EQ(worstHeading(told, drive, &swept), as_they_are);
  EXPECT_EQ(swept.swept, drive.entries.size() - 1);
  EXPECT_EQ(swept.set_right, 0U);
}

}  // namespace
}  // namespace slam::mapping
