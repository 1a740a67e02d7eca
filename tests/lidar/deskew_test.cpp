#include "libslam/lidar/deskew.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libslam/lidar/lidar.h"

namespace slam::lidar {
namespace {

/// A room of 8 x 6 m around the origin; the lidar may be anywhere in it.
double rangeInRoom(const core::Pose2& T_room_lidar, double angle_rad) {
  const double dx = std::cos(T_room_lidar.phi + angle_rad), dy = std::sin(T_room_lidar.phi + angle_rad);
  double nearest_m = 1e9;
  if (dx != 0) nearest_m = std::min(nearest_m, ((dx > 0 ? 4 : -4) - T_room_lidar.x) / dx);
  if (dy != 0) nearest_m = std::min(nearest_m, ((dy > 0 ? 3 : -3) - T_room_lidar.y) / dy);
  return nearest_m;
}

constexpr double kPeriod_s = 0.2;

/// What a spinning lidar sees of the room when the robot drives `T_previous_robot` a period and is at
/// T_room_robot at the end.
Scan sweptScan(const core::Pose2& T_room_robot, const core::Pose2& T_previous_robot, const Sweep& sweep,
               int beams, double fov_rad) {
  Scan scan;
  scan.first_angle_rad = -fov_rad / 2;
  scan.step_rad = beams > 1 ? fov_rad / (beams - 1) : 1;
  scan.max_range_m = 30;
  scan.T_robot_lidar = {0.2, 0.05, 0.1};
  for (int i = 0; i < beams; ++i) {
    const int after = sweep.clockwise ? i : beams - 1 - i;
    const double share = sweep.duration_s * after / (beams - 1) / kPeriod_s;
    const core::Pose2 T_robot_then = core::interpolate({}, core::inverse(T_previous_robot), share);
    scan.ranges_m.push_back(static_cast<float>(
        rangeInRoom(T_room_robot * T_robot_then * scan.T_robot_lidar, scan.angle(static_cast<size_t>(i)))));
  }
  return scan;
}

/// Mean difference of the ranges that both have, and how many.
std::pair<double, int> difference(const Scan& a, const Scan& b) {
  double sum_m = 0;
  int count = 0;
  for (size_t i = 0; i < a.ranges_m.size(); ++i)
    if (isReturn(a.ranges_m[i]) && isReturn(b.ranges_m[i]))
      sum_m += std::abs(a.ranges_m[i] - b.ranges_m[i]), ++count;
  return {sum_m / count, count};
}

TEST(Deskew, ASweepWhileDrivingATurnBecomesTheScanAtItsEnd) {
  const core::Pose2 T_room_robot{0.5, -0.4, 0.3};
  for (const core::Pose2& motion :
       {core::Pose2{0.2, 0, 0}, core::Pose2{0, 0, 0.2}, core::Pose2{0.15, 0.01, -0.15}})
    for (const bool clockwise : {false, true}) {
      const Sweep sweep{0.15, clockwise};
      const auto swept = sweptScan(T_room_robot, motion, sweep, 361, core::kPi);
      const auto still = sweptScan(T_room_robot, {}, sweep, 361, core::kPi);
      const auto result = deskewed(swept, motion, kPeriod_s, sweep);
      EXPECT_GT(difference(swept, still).first, 0.02);
      // Corners are cut by less than a beam's width.
      EXPECT_LT(difference(result, still).first, 1e-3);
      EXPECT_GT(difference(result, still).second, 300);
      EXPECT_EQ(result.ranges_m.size(), swept.ranges_m.size());
    }
}

TEST(Deskew, AFullCircleStaysWhole) {
  const core::Pose2 motion{0.1, 0, 0.1};
  const Sweep sweep{0.19, false};
  const double fov_rad = 2 * core::kPi * 359 / 360;
  const auto result = deskewed(sweptScan({}, motion, sweep, 360, fov_rad), motion, kPeriod_s, sweep);
  const auto still = sweptScan({}, {}, sweep, 360, fov_rad);
  ASSERT_TRUE(still.isFullCircle());
  EXPECT_EQ(difference(result, still).second, 360);
  EXPECT_LT(difference(result, still).first, 2e-3);
}

TEST(Deskew, WhatTheReadingsNoLongerCoverIsLost) {
  // It turned left while it swept from right to left: what was first seen, far right, lies farther right now.
  const core::Pose2 motion{0, 0, 0.2};
  const Sweep sweep{0.2, false};
  const auto result = deskewed(sweptScan({}, motion, sweep, 181, core::kPi), motion, kPeriod_s, sweep);
  EXPECT_TRUE(isReturn(result.ranges_m.front()));
  EXPECT_TRUE(isReturn(result.ranges_m.back()));
  const core::Pose2 other{0, 0, -0.2};
  const auto turned = deskewed(sweptScan({}, other, sweep, 181, core::kPi), other, kPeriod_s, sweep);
  EXPECT_TRUE(std::isnan(turned.ranges_m.front()));
  EXPECT_TRUE(isReturn(turned.ranges_m.back()));
}

TEST(Deskew, NoReturnsTurnAndNothingIsMadeUpBetweenTwoSurfaces) {
  Scan scan;
  scan.first_angle_rad = -0.5;
  scan.step_rad = 0.01;
  scan.ranges_m.assign(101, kNoReturn);
  for (size_t i = 40; i < 60; ++i) scan.ranges_m[i] = i < 50 ? 1.0F : 5.0F;
  const auto result = deskewed(scan, {0, 0, 0.05}, 1, {1, false});
  int near = 0, far = 0;
  for (const float range_m : result.ranges_m) {
    EXPECT_TRUE(std::isnan(range_m) || range_m == kNoReturn || std::abs(range_m - 1) < 0.01 ||
                std::abs(range_m - 5) < 0.01)
        << range_m;
    near += isReturn(range_m) && range_m < 2 ? 1 : 0;
    far += isReturn(range_m) && range_m > 2 ? 1 : 0;
  }
  EXPECT_NEAR(near, 10, 1);
  EXPECT_NEAR(far, 10, 1);
}

TEST(Deskew, AStandingRobotAndNoSweepLeaveTheScan) {
  const auto scan = sweptScan({}, {}, {0.1, false}, 91, core::kPi);
  EXPECT_EQ(deskewed(scan, {}, kPeriod_s, {0.1, false}).ranges_m, scan.ranges_m);
  EXPECT_EQ(deskewed(scan, {0.2, 0, 0.1}, kPeriod_s, {}).ranges_m, scan.ranges_m);
}

TEST(Deskew, TheScanKeepsByWhatItWasDeskewed) {
  const Sweep sweep{0.15, true, 0.5};
  const auto scan = sweptScan({}, {0.1, 0, 0}, sweep, 91, core::kPi);
  EXPECT_EQ(scan.deskewing.sweep.duration_s, 0);
  for (const core::Pose2& motion : {core::Pose2{0.1, 0, 0}, core::Pose2{}}) {
    const auto result = deskewed(scan, motion, kPeriod_s, sweep);
    EXPECT_EQ(result.deskewing.sweep.duration_s, sweep.duration_s);
    EXPECT_EQ(result.deskewing.sweep.clockwise, sweep.clockwise);
    EXPECT_EQ(result.deskewing.sweep.stamped_share, sweep.stamped_share);
    EXPECT_EQ(result.deskewing.T_previous_robot.x, motion.x);
    EXPECT_EQ(result.deskewing.period_s, kPeriod_s);
  }
  // Clockwise the last beam is the first; half of the sweep is over at the stamp.
  EXPECT_NEAR(measuredAgo_s(scan, sweep, 90), 0.075, 1e-12);
  EXPECT_NEAR(measuredAgo_s(scan, sweep, 0), -0.075, 1e-12);
  EXPECT_NEAR(measuredAgo_s(scan, {0.15, false, 1}, 22.5), 0.1125, 1e-12);
}

TEST(Deskew, AStampAtTheBeginningIsSetRightToThen) {
  const core::Pose2 T_room_robot{0.5, -0.4, 0.3}, motion{0.15, 0.01, -0.15};
  const Sweep to_the_end{0.15, false};
  Sweep from_the_start = to_the_end;
  from_the_start.stamped_share = 0;
  // Swept until a moment that is 0.15 s after the stamp: there the robot has gone on as before.
  const double share = to_the_end.duration_s / kPeriod_s;
  const core::Pose2 T_room_end = T_room_robot * core::interpolate({}, motion, share);
  const auto swept = sweptScan(T_room_end, motion, to_the_end, 361, core::kPi);
  const auto still = sweptScan(T_room_robot, {}, to_the_end, 361, core::kPi);
  const auto result = deskewed(swept, motion, kPeriod_s, from_the_start);
  EXPECT_GT(difference(deskewed(swept, motion, kPeriod_s, to_the_end), still).first, 0.05);
  // The motions ahead and back differ by the bend of the way, some millimetres.
  EXPECT_LT(difference(result, still).first, 0.01);
}

TEST(Deskew, TheSweepOfASimulatedLidarIsFromItsFirstToItsLastBeam) {
  LidarOptions lidar;
  lidar.beams = 5, lidar.rate_hz = 10, lidar.sweep = 0.5, lidar.sweep_clockwise = true;
  const auto sweep = sweepOf(lidar);
  EXPECT_DOUBLE_EQ(sweep.duration_s, 0.04);  // five beams share 0.05 s
  EXPECT_TRUE(sweep.clockwise);
  EXPECT_EQ(sweep.stamped_share, 1);
}

}  // namespace
}  // namespace slam::lidar
