#include <gtest/gtest.h>
#include <mrpt/obs/CObservation2DRangeScan.h>

#include <cmath>

#include "libslam/core/error.h"
#include "libslam/lidar/lidar.h"
#include "libslam/lidar/mrpt_types.h"
#include "libslam/robot/drive.h"
#include "libslam/robot/odometry_noise.h"

namespace slam::robot {
namespace {

using core::degToRad;
using core::kPi;

TEST(DriveMotion, StraightTurnAndArc) {
  const core::Pose2 straight = driveMotion({0.5, 0, 4});
  EXPECT_EQ(straight.x, 2);
  EXPECT_EQ(straight.y, 0);
  const core::Pose2 turn = driveMotion({0, 1, kPi / 2});
  EXPECT_EQ(turn.x, 0);
  EXPECT_DOUBLE_EQ(turn.phi, kPi / 2);
  // A quarter of a circle of radius 2 to the left.
  const core::Pose2 arc = driveMotion({2, 1, kPi / 2});
  EXPECT_NEAR(arc.x, 2, 1e-15);
  EXPECT_NEAR(arc.y, 2, 1e-15);
  const core::Pose2 back = driveMotion({-1, 0, 3});
  EXPECT_EQ(back.x, -3);
}

TEST(DriveMotion, HalvesComposeToTheWhole) {
  const Command command{0.7, -0.9, 2.0};
  const core::Pose2 half = driveMotion(command, 1.0), whole = driveMotion(command), twice = half * half;
  EXPECT_NEAR(twice.x, whole.x, 1e-15);
  EXPECT_NEAR(twice.y, whole.y, 1e-15);
  EXPECT_NEAR(twice.phi, whole.phi, 1e-15);
}

TEST(DriveCommands, MoveAndTurnReachWhatIsAsked) {
  const RobotOptions options;
  EXPECT_NEAR(driveMotion(moveCommand(options, -1.2)).x, -1.2, 1e-12);
  EXPECT_NEAR(driveMotion(turnCommand(options, -2.0)).phi, -2.0, 1e-12);
  EXPECT_EQ(moveCommand(options, 0).duration_s, 0);
  EXPECT_NEAR(circumscribedRadius(options), options.side_m / std::sqrt(2.0), 1e-12);
}

TEST(SampleOdometry, IsExactWithoutErrorsAlsoBackwards) {
  OdometryOptions none;
  none.alpha1 = none.alpha2 = none.alpha3 = none.alpha4 = none.heading_bias_radpm = 0;
  none.scale = 1;
  core::RandomStream random(1, "odometry");
  for (const core::Pose2& motion :
       {core::Pose2{1, 0.2, 0.3}, core::Pose2{-1, 0.2, -0.3}, core::Pose2{0, 0, 1}, core::Pose2{0, 0, 0}}) {
    const core::Pose2 reported = sampleOdometry(motion, none, random);
    EXPECT_NEAR(reported.x, motion.x, 1e-15);
    EXPECT_NEAR(reported.y, motion.y, 1e-15);
    EXPECT_NEAR(reported.phi, motion.phi, 1e-15);
  }
}

TEST(SampleOdometry, HasTheVariancesOfTheBook) {
  OdometryOptions options;
  options.alpha1 = 0.04, options.alpha2 = 0.01, options.alpha3 = 0.02, options.alpha4 = 0.03;
  options.scale = 1, options.heading_bias_radpm = 0;
  core::RandomStream random(2, "odometry");
  const core::Pose2 motion{2, 0, 0.5};  // rot1 = 0, trans = 2, rot2 = 0.5
  const int n = 100000;
  double length = 0, length2 = 0, heading = 0, heading2 = 0;
  for (int i = 0; i < n; ++i) {
    const core::Pose2 r = sampleOdometry(motion, options, random);
    const double d = std::hypot(r.x, r.y);
    length += d, length2 += d * d, heading += r.phi, heading2 += r.phi * r.phi;
  }
  length /= n, heading /= n;
  const double length_variance = length2 / n - length * length;
  const double heading_variance = heading2 / n - heading * heading;
  EXPECT_NEAR(length, 2, 0.005);
  EXPECT_NEAR(heading, 0.5, 0.005);
  // alpha3 trans^2 + alpha4 rot2^2, and alpha2 trans^2 twice + alpha1 rot2^2; 2 % is 4 standard errors.
  EXPECT_NEAR(length_variance, 0.08 + 0.0075, 0.02 * 0.0875);
  EXPECT_NEAR(heading_variance, 0.04 + 0.04 + 0.01, 0.02 * 0.09);
}

TEST(SampleOdometry, SystematicErrorsGrowWithTheDistance) {
  OdometryOptions options;
  options.alpha1 = options.alpha2 = options.alpha3 = options.alpha4 = 0;
  options.scale = 1.02, options.heading_bias_radpm = 0.01;
  core::RandomStream random(3, "odometry");
  const core::Pose2 r = sampleOdometry({5, 0, 0}, options, random);
  EXPECT_NEAR(r.x, 5.1, 1e-12);
  EXPECT_NEAR(r.phi, 0.05, 1e-12);
}

TEST(Lidar, FullCircleHasNoDoubledBeam) {
  lidar::LidarOptions options;
  options.fov_rad = 2 * kPi, options.beams = 360;
  EXPECT_DOUBLE_EQ(lidar::beamStep(options), degToRad(1));
  EXPECT_EQ(lidar::firstAngle(options), -kPi);
  options.fov_rad = kPi, options.beams = 181;
  EXPECT_DOUBLE_EQ(lidar::beamStep(options), degToRad(1));
  EXPECT_EQ(lidar::firstAngle(options), -kPi / 2);
}

TEST(LidarErrors, LimitsComeOutAsTheTwoKindsOfNothing) {
  lidar::LidarOptions options;
  options.sigma_m = 0, options.min_range_m = 0.5, options.max_range_m = 10;
  core::RandomStream random(1, "lidar");
  std::vector<float> ranges = {0.4F, 0.6F, 9.9F, 10.1F, lidar::kNoReturn};
  lidar::applyLidarErrors(options, random, ranges);
  EXPECT_TRUE(std::isnan(ranges[0]));
  EXPECT_EQ(ranges[1], 0.6F);
  EXPECT_EQ(ranges[2], 9.9F);
  EXPECT_EQ(ranges[3], lidar::kNoReturn);
  EXPECT_EQ(ranges[4], lidar::kNoReturn);
}

TEST(LidarErrors, NoiseAndDropOutsHaveTheStatedSize) {
  lidar::LidarOptions options;
  options.sigma_m = 0.03, options.drop_out = 0.1, options.min_range_m = 0;
  core::RandomStream random(2, "lidar");
  std::vector<float> ranges(100000, 5.0F);
  lidar::applyLidarErrors(options, random, ranges);
  int lost = 0;
  double sum = 0, squares = 0;
  for (const float r : ranges) {
    if (std::isnan(r)) {
      ++lost;
      continue;
    }
    sum += r - 5.0, squares += (r - 5.0) * (r - 5.0);
  }
  const int kept = 100000 - lost;
  EXPECT_NEAR(lost, 10000, 380);                           // 4 sigma of a binomial
  EXPECT_NEAR(sum / kept, 0, 4 * 0.03 / std::sqrt(kept));  // 4 standard errors
  EXPECT_NEAR(std::sqrt(squares / kept), 0.03, 4 * 0.03 / std::sqrt(2.0 * kept));
}

TEST(LidarErrors, SwitchingDropOutsOffMovesNoOtherReading) {
  lidar::LidarOptions with, without;
  with.drop_out = 0.5;
  core::RandomStream a(3, "lidar"), b(3, "lidar");
  std::vector<float> x(200, 4.0F), y(200, 4.0F);
  lidar::applyLidarErrors(with, a, x);
  lidar::applyLidarErrors(without, b, y);
  for (size_t i = 0; i < x.size(); ++i)
    if (!std::isnan(x[i])) {
      EXPECT_EQ(x[i], y[i]);
    }
}

lidar::Scan exampleScan() {
  lidar::Scan scan;
  scan.time_s = 1700000000.25;
  scan.first_angle_rad = degToRad(-60);
  scan.step_rad = degToRad(30);
  scan.max_range_m = 8;
  scan.range_sigma_m = 0.01;
  scan.T_robot_lidar = {0.1, -0.2, degToRad(15)};
  scan.ranges_m = {1.5F, lidar::kNoReturn, lidar::kLostReading, 7.5F, 2.0F, 3.0F};
  return scan;
}

TEST(MrptScan, KeepsBeamsWhereTheyPoint) {
  const lidar::Scan scan = exampleScan();  // from -60 to +90 degrees: not centred
  const lidar::Scan back = lidar::fromMrpt(*lidar::toMrpt(scan));
  ASSERT_EQ(back.ranges_m.size(), scan.ranges_m.size());
  EXPECT_NEAR(back.time_s, scan.time_s, 1e-7);  // MRPT's tick
  for (size_t i = 0; i < scan.ranges_m.size(); ++i) {
    if (std::isnan(scan.ranges_m[i]))
      EXPECT_TRUE(std::isnan(back.ranges_m[i]));
    else
      EXPECT_EQ(back.ranges_m[i], scan.ranges_m[i]);
    // MRPT stores the aperture as float.
    EXPECT_NEAR(back.T_robot_lidar.phi + back.angle(i), scan.T_robot_lidar.phi + scan.angle(i), 1e-6);
  }
  EXPECT_EQ(back.T_robot_lidar.x, 0.1);
  EXPECT_EQ(back.T_robot_lidar.y, -0.2);
}

TEST(MrptScan, TurnsAClockwiseSweepRound) {
  auto observation = *lidar::toMrpt(exampleScan());
  observation.rightToLeft = false;
  const lidar::Scan back = lidar::fromMrpt(observation);
  EXPECT_EQ(back.ranges_m.front(), 3.0F);
  EXPECT_EQ(back.ranges_m.back(), 1.5F);
}

TEST(MrptScan, RefusesWhatIsNoScan) {
  lidar::Scan one = exampleScan();
  one.ranges_m.resize(1);
  EXPECT_THROW(lidar::toMrpt(one), core::ContractError);
  auto observation = *lidar::toMrpt(exampleScan());
  observation.aperture = 0;
  EXPECT_THROW(lidar::fromMrpt(observation), core::InputError);
  observation = *lidar::toMrpt(exampleScan());
  observation.resizeScan(1);
  EXPECT_THROW(lidar::fromMrpt(observation), core::InputError);
}

TEST(ScanPoints, AreInTheRobotFrame) {
  lidar::Scan scan;
  scan.first_angle_rad = 0;
  scan.step_rad = kPi / 2;
  scan.T_robot_lidar = {1, 0, kPi / 2};
  scan.ranges_m = {2, lidar::kNoReturn, 3, lidar::kLostReading};
  const auto points = lidar::scanPoints(scan);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_NEAR(points[0].x, 1, 1e-15);
  EXPECT_NEAR(points[0].y, 2, 1e-15);
  EXPECT_NEAR(points[1].y, -3, 1e-15);
  scan.ranges_m.assign(4, 1);
  EXPECT_TRUE(scan.isFullCircle());
  scan.ranges_m.assign(3, 1);
  EXPECT_FALSE(scan.isFullCircle());
}

}  // namespace
}  // namespace slam::robot
