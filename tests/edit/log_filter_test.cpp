#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/obs/CActionRobotMovement3D.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/poses/CPosePDFGaussian.h>

#include "libslam/logs/log_format.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"
#include "tests/edit/edited_logs.h"
#include "tests/logs/log_fixtures.h"

namespace slam::edit {
namespace {

using namespace logs;

using mrpt::obs::CActionCollection;
using mrpt::obs::CActionRobotMovement2D;
using mrpt::obs::CObservation2DRangeScan;
using testing::errorOf;
using ::testing::HasSubstr;

TEST(FilterLog, DropsByLabelAndTouchesNothingElse) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    for (int i = 0; i < 3; ++i)
      log << rawOdometry(kStart_s + i, i) << rawScan(kStart_s + i, "FRONT") << rawScan(kStart_s + i, "REAR");
  }
  FilterOptions options;
  options.drop_labels = {"REAR"};
  filter(folder / "a.rawlog", folder / "b.rawlog", options);
  EXPECT_EQ(unpacked(folder / "b.rawlog"), unpacked(bareLog(folder, "front.rawlog", 3, "FRONT")));
  options = {};
  options.keep_labels = {"ODOMETRY", "FRONT"};
  filter(folder / "a.rawlog", folder / "c.rawlog", options);
  EXPECT_EQ(readBytes(folder / "b.rawlog"), readBytes(folder / "c.rawlog"));
  options.keep_labels = {"ODOMETRY", "TOP"};
  EXPECT_EQ(errorOf([&] { filter(folder / "a.rawlog", folder / "d.rawlog", options); }),
            (folder / "a.rawlog") +
                ": no observation with the sensor label 'TOP', found 'FRONT', 'ODOMETRY', 'REAR'");
}

TEST(FilterLog, TakesSensorsOutOfFrames) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    log << collection(wheelAction(kStart_s, 1))
        << frame(rawScan(kStart_s, "FRONT"), rawScan(kStart_s, "REAR"))
        << collection(wheelAction(kStart_s + 1, 2)) << frame(rawScan(kStart_s + 1, "REAR"))
        << collection(wheelAction(kStart_s + 2, 4)) << frame(rawScan(kStart_s + 2, "FRONT"));
  }
  FilterOptions options;
  options.drop_labels = {"REAR"};
  const auto counts = filter(folder / "a.rawlog", folder / "b.rawlog", options);
  EXPECT_EQ(outline(folder / "b.rawlog"),
            (std::vector<std::string>{"actions", "frame [FRONT 0.0]", "actions", "frame [FRONT 2.0]"}));
  EXPECT_EQ(counts.unchanged, 2U);
  EXPECT_EQ(counts.changed, 2U) << "a frame, and the action that took up another";
  EXPECT_EQ(counts.composed, 1U);
  EXPECT_EQ(counts.dropped, 2U);
  EXPECT_NEAR(readLog(folder / "b.rawlog")[1].T_previous_robot.x, 6, 1e-9);
}

TEST(FilterLog, EveryThirdScanOfEachLidarOfABareLog) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    for (int i = 0; i < 7; ++i) {
      log << rawOdometry(kStart_s + i, i) << rawScan(kStart_s + i, "FRONT");
      if (i % 2 == 0) log << rawScan(kStart_s + i, "REAR");
    }
  }
  FilterOptions options;
  options.every = 3;
  filter(folder / "a.rawlog", folder / "b.rawlog", options);
  EXPECT_EQ(outline(folder / "b.rawlog"),
            (std::vector<std::string>{"ODOMETRY 0.0", "FRONT 0.0", "REAR 0.0", "ODOMETRY 1.0", "ODOMETRY 2.0",
                                      "ODOMETRY 3.0", "FRONT 3.0", "ODOMETRY 4.0", "ODOMETRY 5.0",
                                      "ODOMETRY 6.0", "FRONT 6.0", "REAR 6.0"}));
}

TEST(FilterLog, DecimatingAnActionLogKeepsTheWayOfTheRobot) {
  const testing::TempFolder folder;
  const auto path = actionLog(folder, "a.rawlog", 10);
  FilterOptions options;
  options.every = 3;
  const auto counts = filter(path, folder / "b.rawlog", options);
  const auto all = readLog(path), some = readLog(folder / "b.rawlog");
  ASSERT_EQ(some.size(), 4U);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(some[i].scan.time_s, all[3 * i].scan.time_s);
    EXPECT_NEAR(some[i].T_odom_robot.x, all[3 * i].T_odom_robot.x, 1e-6)
        << "MRPT's odometry readings are doubles";
    EXPECT_NEAR(some[i].T_odom_robot.y, all[3 * i].T_odom_robot.y, 1e-6);
    EXPECT_NEAR(core::angleDifference(some[i].T_odom_robot.phi, all[3 * i].T_odom_robot.phi), 0, 1e-6);
  }
  EXPECT_EQ(counts.composed, 3U);
  EXPECT_EQ(counts.read, 20U);
  EXPECT_EQ(counts.unchanged, 5U) << "the first step and three frames";
}

TEST(FilterLog, ComposesEveryWayOfMeasuringTheMotion) {
  using mrpt::poses::CPose2D;
  using mrpt::poses::CPosePDFGaussian;
  const auto matched = [](double x_m, double turn_rad, double variance) {
    CActionRobotMovement2D action;
    mrpt::math::CMatrixDouble33 covariance;
    covariance.setIdentity();
    covariance *= variance;
    action.estimationMethod = CActionRobotMovement2D::emScan2DMatching;
    action.poseChange = CPosePDFGaussian::Create(CPose2D(x_m, 0, turn_rad), covariance);
    return action;
  };
  const auto spatial = [](double x_m) {
    mrpt::obs::CActionRobotMovement3D action;
    action.poseChange.mean = mrpt::poses::CPose3D(x_m, 0, 0, 0, 0, 0);
    action.poseChange.cov.setIdentity();
    action.estimationMethod = mrpt::obs::CActionRobotMovement3D::emVisualOdometry;
    return action;
  };
  auto wheels = wheelAction(kStart_s, 1);
  wheels.hasEncodersInfo = true;
  wheels.encoderLeftTicks = 5;
  wheels.encoderRightTicks = 7;
  wheels.motionModelConfiguration.gaussianModel.a1 = 0.25;
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    log << collection(wheels) << frame(rawScan(kStart_s, "L"));
    for (int i = 1; i < 3; ++i)
      log << collection(wheels, matched(2, core::kPi / 2, 0.01), spatial(3))
          << frame(rawScan(kStart_s + i, "L"));
  }
  FilterOptions options;
  options.every = 2;
  filter(folder / "a.rawlog", folder / "b.rawlog", options);
  const auto objects = objectsOf(folder / "b.rawlog");
  ASSERT_EQ(objects.size(), 4U);
  const auto& actions = as<CActionCollection>(objects[2]);
  ASSERT_EQ(actions.size(), 3U);
  const auto sum = actions.getActionByClass<CActionRobotMovement2D>(0);
  EXPECT_EQ(sum->rawOdometryIncrementReading.x(), 2);
  EXPECT_TRUE(sum->hasEncodersInfo);
  EXPECT_EQ(sum->encoderLeftTicks, 10);
  EXPECT_EQ(sum->encoderRightTicks, 14);
  EXPECT_NEAR(sum->motionModelConfiguration.gaussianModel.a1, 0.25, 1e-9);
  const auto scans = actions.getActionByClass<CActionRobotMovement2D>(1);
  const auto mean = scans->poseChange->getMeanVal();
  EXPECT_NEAR(mean.x(), 2, 1e-6);
  EXPECT_NEAR(mean.y(), 2, 1e-6);
  EXPECT_NEAR(std::abs(mean.phi()), core::kPi, 1e-6);
  // By hand: the turn's variance adds up; that of y takes 2 m times the first turn's.
  const auto covariance = scans->poseChange->getCovariance();
  EXPECT_NEAR(covariance(2, 2), 0.02, 1e-6);
  EXPECT_NEAR(covariance(0, 0), 0.02 + 4 * 0.01, 1e-6);
  const auto full = actions.getActionByClass<mrpt::obs::CActionRobotMovement3D>(0);
  EXPECT_NEAR(full->poseChange.mean.x(), 6, 1e-6);
  EXPECT_EQ(full->estimationMethod, mrpt::obs::CActionRobotMovement3D::emVisualOdometry);
}

TEST(FilterLog, StepsWithoutAnIncrementAddNone) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    log << collection(wheelAction(kStart_s, 1)) << frame(rawScan(kStart_s, "L"));
    log << collection(wheelAction(kStart_s + 1, 2)) << frame(rawScan(kStart_s + 1, "L"));
    log << CActionCollection() << frame(rawScan(kStart_s + 2, "L"));
  }
  FilterOptions options;
  options.every = 2;
  filter(folder / "a.rawlog", folder / "b.rawlog", options);
  EXPECT_NEAR(readLog(folder / "b.rawlog")[1].T_previous_robot.x, 2, 1e-9);
}

TEST(FilterLog, DropsTheTruth) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    mrpt::obs::CObservationRobotPose truth;
    truth.sensorLabel = objects::kTruthLabel;
    truth.timestamp = mrptTime(kStart_s);
    log << truth << rawOdometry(kStart_s, 0) << rawScan(kStart_s, "LASER");
  }
  FilterOptions options;
  options.drop_truth = true;
  filter(folder / "a.rawlog", folder / "b.rawlog", options);
  EXPECT_EQ(outline(folder / "b.rawlog"), (std::vector<std::string>{"ODOMETRY 0.0", "LASER 0.0"}));
}

TEST(FilterLog, MendsWhatTheLogSaysWrongly) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    auto scan = rawScan(kStart_s, "L");
    scan.maxRange = 100;
    scan.setScanRange(1, 81.83F);
    scan.setScanRange(2, 81.82F);
    scan.sensorPose.setFromValues(1, 2, 0.5, 0.3, 0.1, 0);
    log << rawOdometry(kStart_s, 0) << scan;
  }
  FilterOptions options;
  options.no_return_m = 81.825;
  options.step_rad = core::degToRad(1);
  options.mount = core::Pose2{0.1, -0.2, core::degToRad(90)};
  options.shift_s = {{"ODOMETRY", -0.25}};
  const auto counts = filter(folder / "a.rawlog", folder / "b.rawlog", options);
  EXPECT_EQ(counts.changed, 2U);
  EXPECT_EQ(outline(folder / "b.rawlog"), (std::vector<std::string>{"ODOMETRY -0.2", "L 0.0"}));
  const auto objects = objectsOf(folder / "b.rawlog");
  const auto& scan = as<CObservation2DRangeScan>(objects[1]);
  EXPECT_FALSE(scan.getScanRangeValidity(1));
  EXPECT_EQ(scan.getScanRange(1), 81.83F) << "marked, not altered";
  EXPECT_TRUE(scan.getScanRangeValidity(2));
  EXPECT_FLOAT_EQ(scan.maxRange, 81.825F);
  EXPECT_NEAR(scan.aperture, core::degToRad(4), 1e-7);
  EXPECT_NEAR(scan.sensorPose.x(), 0.1, 1e-12);
  EXPECT_NEAR(scan.sensorPose.yaw(), core::kPi / 2, 1e-12);
  EXPECT_NEAR(scan.sensorPose.z(), 0.5, 1e-12) << "what the plane does not know stays";
  EXPECT_NEAR(scan.sensorPose.pitch(), 0.1, 1e-12);
  options = {};
  options.step_rad = core::degToRad(100);
  EXPECT_THAT(errorOf([&] { filter(folder / "a.rawlog", folder / "c.rawlog", options); }),
              HasSubstr("5 readings 100 deg apart go round more than once"));
}

TEST(FilterLog, AShiftMovesStampsByWholeTicks) {
  const testing::TempFolder folder;
  const auto path = bareLog(folder, "a.rawlog", 2);
  FilterOptions options;
  options.shift_s = {{"LASER", 0.6289}};
  filter(path, folder / "b.rawlog", options);
  options.shift_s = {{"LASER", -0.6289}};
  filter(folder / "b.rawlog", folder / "c.rawlog", options);
  EXPECT_NE(unpacked(folder / "b.rawlog"), unpacked(path));
  EXPECT_EQ(unpacked(folder / "c.rawlog"), unpacked(path));
}

}  // namespace
}  // namespace slam::edit
