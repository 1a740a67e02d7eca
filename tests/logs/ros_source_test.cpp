#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/obs/CObservationComment.h>

#include "libslam/lidar/mrpt_types.h"
#include "libslam/objects/sweep_note.h"
#include "libslam/testing/error_of.h"
#include "tests/logs/ros_fixtures.h"

namespace slam::logs {
namespace {

using mrpt::obs::CObservation2DRangeScan;
using mrpt::obs::CObservationOdometry;
using mrpt::obs::CObservationRobotPose;
using ::testing::HasSubstr;

bags::RosTransforms transforms(std::vector<bags::RosTransform> list) {
  return {std::move(list)};
}

std::shared_ptr<CObservation2DRangeScan> onlyScan(const FakeBag& bag) {
  const auto source = bag.open();
  const auto scans = only<CObservation2DRangeScan>(readAll(*source));
  EXPECT_EQ(scans.size(), 1U);
  return scans.empty() ? nullptr : scans.front();
}

/// Where the end of each beam is in the robot's plane, by ROS's own rule: beam i at angle_min + i *
/// increment in the lidar's frame.
std::vector<core::Pose2> beamEnds(const CObservation2DRangeScan& observation) {
  const auto scan = lidar::fromMrpt(observation);
  std::vector<core::Pose2> ends;
  for (size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double angle = scan.first_angle_rad + static_cast<double>(i) * scan.step_rad;
    const double range_m = scan.ranges_m[i];
    ends.push_back(scan.T_robot_lidar * core::Pose2{range_m * std::cos(angle), range_m * std::sin(angle), 0});
  }
  return ends;
}

TEST(RosSource, ReadsRangesByRep117) {
  FakeBag bag;
  bag.add("/front/scan", bags::kLaserScanType, kRosStart_ns,
          laserScan("laser", {1.5F, kInf, -kInf, kNan, 0.05F, 10.5F, 10.0F, 9.75F, 0.0F}));
  const auto scan = onlyScan(bag);
  EXPECT_EQ(scan->sensorLabel, "front/scan");
  EXPECT_EQ(scan->maxRange, 10.0F);
  EXPECT_EQ(stampNs(*scan), kRosStart_ns);
  const std::vector<float> expected{1.5F, 10, 0, 0, 0, 10, 10, 9.75F, 0};
  for (size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(scan->getScanRange(i), expected[i]) << i;
    EXPECT_EQ(scan->getScanRangeValidity(i), i == 0 || i == 7) << i;
  }
  const auto ours = lidar::fromMrpt(*scan);
  EXPECT_EQ(ours.ranges_m[1], lidar::kNoReturn);
  EXPECT_EQ(ours.ranges_m[5], lidar::kNoReturn);
  EXPECT_TRUE(std::isnan(ours.ranges_m[2]));
  EXPECT_TRUE(std::isnan(ours.ranges_m[4]));
}

TEST(RosSource, TakesTheFieldOfViewFromTheIncrementWhereTheStatedEndDisagrees) {
  auto scan = laserScan("laser", {1, 2, 3, 4, 5});
  scan.angle_max = scan.angle_min + 5 * scan.angle_increment;  // a driver that counts one step too many
  FakeBag bag;
  bag.add("/scan", bags::kLaserScanType, kRosStart_ns, scan);
  const auto observation = onlyScan(bag);
  EXPECT_FLOAT_EQ(observation->aperture, 1.0F);
  EXPECT_NEAR(observation->sensorPose.yaw(), 0, 1e-7);
}

TEST(RosSource, TurnsASensorWhoseSweepIsNotCentred) {
  auto scan = laserScan("laser", {1, 2, 3});
  scan.angle_min = 0;
  scan.angle_max = 1;
  FakeBag bag;
  bag.add("/scan", bags::kLaserScanType, kRosStart_ns, scan);
  const auto ends = beamEnds(*onlyScan(bag));
  EXPECT_NEAR(ends[0].x, 1, 1e-6);
  EXPECT_NEAR(ends[0].y, 0, 1e-6);
  EXPECT_NEAR(ends[2].x, 3 * std::cos(1.0), 1e-6);
  EXPECT_NEAR(ends[2].y, 3 * std::sin(1.0), 1e-6);
}

TEST(RosSource, TurnsAClockwiseSweepRound) {
  auto scan = laserScan("laser", {1, 2, 3});
  scan.angle_min = 0.25F;
  scan.angle_increment = -0.5F;
  scan.angle_max = -0.75F;
  FakeBag bag;
  bag.add("/scan", bags::kLaserScanType, kRosStart_ns, scan);
  const auto observation = onlyScan(bag);
  const auto ends = beamEnds(*observation);
  ASSERT_EQ(ends.size(), 3U);
  EXPECT_TRUE(observation->rightToLeft);
  for (const size_t i : {0U, 1U, 2U}) {
    const double range_m = 1.0 + static_cast<double>(i), angle = 0.25 - 0.5 * static_cast<double>(i);
    EXPECT_NEAR(ends[2 - i].x, range_m * std::cos(angle), 1e-6);
    EXPECT_NEAR(ends[2 - i].y, range_m * std::sin(angle), 1e-6);
  }
}

TEST(RosSource, FindsTheMountingThroughAChainOfFrames) {
  FakeBag bag;
  bag.add("/tf_static", bags::kTransformsType, kRosStart_ns,
          transforms({transform("/base_link", "/deck", {1, 0, 0.5}, turned(core::kPi / 2))}));
  bag.add("/tf", bags::kTransformsType, kRosStart_ns, transforms({transform("deck", "laser", {0.25, 0, 0})}));
  bag.add("/odom", bags::kOdometryType, kRosStart_ns, rosOdometry(kRosStart_ns, 0));
  bag.add("/scan", bags::kLaserScanType, kRosStart_ns, laserScan("/laser", {1, 2, 3}));
  const auto mount = onlyScan(bag)->sensorPose;
  EXPECT_NEAR(mount.x(), 1, 1e-12);
  EXPECT_NEAR(mount.y(), 0.25, 1e-12);
  EXPECT_NEAR(mount.z(), 0.5, 1e-12);
  EXPECT_NEAR(mount.yaw(), core::kPi / 2, 1e-12);
}

TEST(RosSource, FindsTheMountingThatComesAfterTheFirstScan) {
  FakeBag bag;
  bag.add("/scan", bags::kLaserScanType, kRosStart_ns, laserScan("laser", {1, 2, 3}));
  bag.add("/tf_static", bags::kTransformsType, kRosStart_ns + 1,
          transforms({transform("base_link", "laser", {0.3, 0, 0})}));
  EXPECT_EQ(onlyScan(bag)->sensorPose.x(), 0.3);
}

TEST(RosSource, MeasuresTheMountingFromTheFrameWhosePoseTheOdometryGives) {
  FakeBag bag;
  bag.add("/tf_static", bags::kTransformsType, kRosStart_ns,
          transforms({transform("base_footprint", "base_link", {0.5, 0, 0.1}),
                      transform("base_link", "laser", {0.25, 0, 0})}));
  bag.add("/odom", bags::kOdometryType, kRosStart_ns, rosOdometry(kRosStart_ns, 0, "base_footprint"));
  bag.add("/scan", bags::kLaserScanType, kRosStart_ns, laserScan("laser", {1, 2, 3}));
  EXPECT_NEAR(onlyScan(bag)->sensorPose.x(), 0.75, 1e-12);
}

TEST(RosSource, NeverLooksForTheMountingThroughTheFrameInWhichTheRobotMoves) {
  FakeBag bag;
  bag.add("/tf", bags::kTransformsType, kRosStart_ns,
          transforms({transform("odom", "base_link", {5, 0, 0}), transform("odom", "laser", {6, 0, 0})}));
  bag.add("/scan", bags::kLaserScanType, kRosStart_ns, laserScan("laser", {1, 2, 3}));
  const auto source = bag.open();
  const auto scans = only<CObservation2DRangeScan>(readAll(*source));
  EXPECT_EQ(scans.at(0)->sensorPose.x(), 0);
  EXPECT_THAT(source->skipped(), HasSubstr("no transform leads to the lidar's frame 'laser'"));
}

TEST(RosSource, FollowsAMountingThatChanges) {
  FakeBag bag;
  for (const double x_m : {0.1, 0.2}) {
    bag.add("/tf_static", bags::kTransformsType, kRosStart_ns,
            transforms({transform("base_link", "laser", {x_m, 0, 0})}));
    bag.add("/scan", bags::kLaserScanType, kRosStart_ns, laserScan("laser", {1, 2, 3}));
  }
  const auto source = bag.open();
  const auto scans = only<CObservation2DRangeScan>(readAll(*source));
  EXPECT_EQ(scans.at(0)->sensorPose.x(), 0.1);
  EXPECT_EQ(scans.at(1)->sensorPose.x(), 0.2);
}

TEST(RosSource, SurvivesALoopOfFrames) {
  FakeBag bag;
  bag.add("/tf_static", bags::kTransformsType, kRosStart_ns,
          transforms({transform("a", "laser", {1, 0, 0}), transform("laser", "a", {1, 0, 0})}));
  bag.add("/scan", bags::kLaserScanType, kRosStart_ns, laserScan("laser", {1, 2, 3}));
  EXPECT_EQ(onlyScan(bag)->sensorPose.x(), 0);
}

// The lidar under the robot's belly: its own z axis points down, so its beams run clockwise as the robot sees
// them. Where each beam ends in the robot's plane must be as the full 3D transform says.
TEST(RosSource, TurnsALidarThatHangsUpsideDownUpright) {
  const double yaw_rad = 0.4;
  const mrpt::poses::CPose3D T_base_laser(0.2, -0.1, 0.15, yaw_rad, 0, core::kPi);
  mrpt::math::CQuaternionDouble q;
  T_base_laser.getAsQuaternion(q);
  auto scan = laserScan("laser", {1, 2, 3, 4});
  scan.angle_min = -0.3F;
  scan.angle_increment = 0.5F;
  scan.angle_max = 1.2F;
  FakeBag bag;
  bag.add("/tf_static", bags::kTransformsType, kRosStart_ns,
          transforms({transform("base_link", "laser", {0.2, -0.1, 0.15}, {q.x(), q.y(), q.z(), q.r()})}));
  bag.add("/scan", bags::kLaserScanType, kRosStart_ns, scan);
  const auto observation = onlyScan(bag);
  EXPECT_NEAR(observation->sensorPose.roll(), 0, 1e-9);
  const auto ends = beamEnds(*observation);
  for (size_t i = 0; i < 4; ++i) {
    const double angle = -0.3 + 0.5 * static_cast<double>(i), range_m = 1.0 + static_cast<double>(i);
    double x = 0, y = 0, z = 0;
    T_base_laser.composePoint(range_m * std::cos(angle), range_m * std::sin(angle), 0, x, y, z);
    EXPECT_NEAR(ends[3 - i].x, x, 1e-6) << i;
    EXPECT_NEAR(ends[3 - i].y, y, 1e-6) << i;
  }
}

TEST(RosSource, TakesOdometryFromTfWhereNothingElseHasIt) {
  FakeBag bag;
  for (int i = 0; i < 3; ++i) {
    auto moved = transform("robot1/odom", "base_footprint", {0.5 * i, 0, 0}, turned(0.1 * i));
    moved.header.stamp_ns = kRosStart_ns + std::int64_t{1000} * i;
    bag.add("/tf", bags::kOldTransformsType, kRosStart_ns, transforms({transform("a", "b", {}), moved}),
            bags::RosEncoding::kRos1);
  }
  bag.add("/tf_static", bags::kTransformsType, kRosStart_ns,
          transforms({transform("base_footprint", "laser", {0.2, 0, 0})}));
  bag.add("/scan", bags::kLaserScanType, kRosStart_ns, laserScan("laser", {1, 2, 3}));
  const auto source = bag.open();
  const auto objects = readAll(*source);
  const auto odometry = only<CObservationOdometry>(objects);
  ASSERT_EQ(odometry.size(), 3U);
  EXPECT_EQ(odometry[2]->odometry.x(), 1.0);
  EXPECT_NEAR(odometry[2]->odometry.phi(), 0.2, 1e-15);
  EXPECT_EQ(stampNs(*odometry[2]), kRosStart_ns + 2000);
  EXPECT_EQ(only<CObservation2DRangeScan>(objects).at(0)->sensorPose.x(), 0.2);
}

TEST(RosSource, FindsTheOdometryThatSpeaksSomeSecondsLater) {
  FakeBag bag;
  bag.add("/tf_static", bags::kTransformsType, kRosStart_ns,
          transforms({transform("base_link", "laser", {0.2, 0, 0})}));
  bag.add("/filtered", bags::kOdometryType, kRosStart_ns, rosOdometry(kRosStart_ns, 1));
  bag.add("/scan", bags::kLaserScanType, kRosStart_ns, laserScan("laser", {1, 2, 3}));
  for (const std::int64_t after_ns : {1'000'000'000LL, 4'000'000'000LL}) {
    bag.add("/scan", bags::kLaserScanType, kRosStart_ns + after_ns, laserScan("laser", {1, 2, 3}));
    bag.add("/odom", bags::kOdometryType, kRosStart_ns + 3 * after_ns / 2,
            rosOdometry(kRosStart_ns + 3 * after_ns / 2, 2));
  }
  const auto source = bag.open();
  const auto odometry = only<CObservationOdometry>(readAll(*source));
  ASSERT_EQ(odometry.size(), 2U);
  EXPECT_EQ(odometry[0]->odometry.x(), 2);
}

TEST(RosSource, PrefersTheOdometryTopicToTfAndOneTopicToTheOthers) {
  FakeBag bag;
  bag.add("/tf", bags::kTransformsType, kRosStart_ns,
          transforms({transform("odom", "base_link", {7, 0, 0})}));
  bag.add("/filtered", bags::kOdometryType, kRosStart_ns, rosOdometry(kRosStart_ns, 1));
  bag.add("/odom", bags::kOdometryType, kRosStart_ns, rosOdometry(kRosStart_ns, 2));
  const auto source = bag.open();
  const auto odometry = only<CObservationOdometry>(readAll(*source));
  ASSERT_EQ(odometry.size(), 1U);
  EXPECT_EQ(odometry[0]->odometry.x(), 2);
  EXPECT_EQ(source->skipped(), "1 message of 1 topic (/filtered nav_msgs/Odometry)");

  bags::RosReadOptions options;
  options.odometry_topic = "/filtered";
  const auto chosen = bag.open(options);
  EXPECT_EQ(only<CObservationOdometry>(readAll(*chosen)).at(0)->odometry.x(), 1);
}

TEST(RosSource, KeepsTheTruthApartFromTheOdometry) {
  FakeBag bag;
  bag.add("/base_pose_ground_truth", bags::kOdometryType, kRosStart_ns, rosOdometry(kRosStart_ns, 4));
  bag.add("/mocap", bags::kPoseStampedType, kRosStart_ns,
          bags::RosPoseStamped{{kRosStart_ns, "world"}, {{8, 0, 0}, turned(1)}});
  bags::RosReadOptions options;
  const auto source = bag.open(options);
  const auto objects = readAll(*source);
  EXPECT_EQ(only<CObservationOdometry>(objects).size(), 0U);
  ASSERT_EQ(only<CObservationRobotPose>(objects).size(), 1U);
  EXPECT_EQ(only<CObservationRobotPose>(objects)[0]->sensorLabel, objects::kTruthLabel);
  EXPECT_EQ(only<CObservationRobotPose>(objects)[0]->pose.mean.x(), 4);

  options.truth_topics = {"/mocap"};
  const auto chosen = bag.open(options);
  const auto truth = only<CObservationRobotPose>(readAll(*chosen));
  ASSERT_EQ(truth.size(), 1U);
  EXPECT_EQ(truth[0]->pose.mean.x(), 8);
  EXPECT_NEAR(truth[0]->pose.mean.yaw(), 1, 1e-15);
}

TEST(RosSource, TakesTheFirstEchoOfEachBeam) {
  bags::RosMultiEchoLaserScan scan;
  scan.header = {kRosStart_ns, "laser"};
  scan.angle_min = -0.5F;
  scan.angle_max = 0.5F;
  scan.angle_increment = 0.5F;
  scan.range_max = 10;
  scan.ranges = {{1.5F, 3}, {}, {2.5F}};
  scan.intensities = {{7, 8}, {}, {9}};
  FakeBag bag;
  bag.add("/horizontal", bags::kMultiEchoType, kRosStart_ns, scan);
  const auto observation = onlyScan(bag);
  ASSERT_EQ(observation->getScanSize(), 3U);
  EXPECT_EQ(observation->getScanRange(0), 1.5F);
  EXPECT_FALSE(observation->getScanRangeValidity(1));
  EXPECT_EQ(observation->getScanRange(1), 10.0F);
  EXPECT_EQ(observation->getScanRange(2), 2.5F);
  EXPECT_EQ(observation->getScanIntensity(2), 9);
}

TEST(RosSource, GivesAHeaderWithoutStampTheRecordersTime) {
  auto scan = laserScan("laser", {1, 2, 3});
  scan.header.stamp_ns = 0;
  FakeBag bag;
  bag.add("/scan", bags::kLaserScanType, kRosStart_ns + 700, scan);
  const auto source = bag.open();
  EXPECT_EQ(stampNs(*only<CObservation2DRangeScan>(readAll(*source)).at(0)), kRosStart_ns + 700);
  EXPECT_THAT(source->skipped(), HasSubstr("1 header without a stamp took the recorder's time"));
}

TEST(RosSource, NamesTheMessageThatCannotBeDecoded) {
  FakeBag bag;
  bag.add("/scan", bags::kLaserScanType, kRosStart_ns, laserScan("laser", {1, 2, 3}));
  bag.addBytes({"/scan", bags::kLaserScanType, bags::RosEncoding::kCdr, "", ""}, kRosStart_ns,
               bags::encodeRos(bags::RosEncoding::kCdr, rosOdometry(kRosStart_ns, 1)));
  const auto source = bag.open();
  EXPECT_NE(source->next(), nullptr);
  EXPECT_THAT(testing::errorOf([&] { source->next(); }),
              HasSubstr("fake.bag: message 2 (/scan): sensor_msgs/LaserScan: "));
}

TEST(RosSource, RefusesAnotherDefinitionOfTheSameType) {
  FakeBag bag;
  bag.addBytes({"/scan", bags::kLaserScanType, bags::RosEncoding::kRos1, "", "0123"}, kRosStart_ns,
               bags::encodeRos(bags::RosEncoding::kRos1, laserScan("laser", {1, 2, 3})));
  const auto source = bag.open();
  EXPECT_EQ(
      testing::errorOf([&] { source->next(); }),
      "fake.bag: message 1 (/scan): sensor_msgs/LaserScan: a definition with the MD5 sum 0123, expected "
      "90c7ef2dc6895d81024acba2ac42f369");
}

TEST(RosSource, SaysWhatABagHasThatHoldsNothingToRead) {
  const FakeBag empty;
  const auto nothing = empty.open();
  EXPECT_EQ(testing::errorOf([&] { nothing->next(); }),
            "fake.bag: holds no messages, expected laser scans (sensor_msgs/LaserScan) or odometry "
            "(nav_msgs/Odometry)");
  FakeBag bag;
  bag.addBytes({"/camera", "sensor_msgs/Image", bags::RosEncoding::kCdr, "", ""}, kRosStart_ns, "xyz");
  bag.addBytes({"/chat", "chat", bags::RosEncoding::kCdr, "encoded as json", ""}, kRosStart_ns, "{}");
  const auto source = bag.open();
  EXPECT_EQ(
      testing::errorOf([&] { source->next(); }),
      "fake.bag: holds only 2 messages of 2 topics (/camera sensor_msgs/Image, /chat chat encoded as json), "
      "expected laser scans (sensor_msgs/LaserScan) or odometry (nav_msgs/Odometry)");
}

TEST(RosSource, RefusesAPoseWithoutOrientation) {
  auto odometry = rosOdometry(kRosStart_ns, 1);
  odometry.pose.orientation = {0, 0, 0, 0};
  FakeBag bag;
  bag.add("/odom", bags::kOdometryType, kRosStart_ns, odometry);
  const auto source = bag.open();
  EXPECT_EQ(testing::errorOf([&] { source->next(); }),
            "fake.bag: message 1 (/odom): a pose that is not finite, or with a quaternion of length 0");
}

TEST(RosSource, NotesTheTimesOfTheBeams) {
  // Beams given from left to right, the one at the right end last: clockwise. The stamp is the first beam's.
  auto scan = laserScan("laser", {1, 2, 3, 4, 5});
  std::swap(scan.angle_min, scan.angle_max);
  scan.angle_increment = -scan.angle_increment;
  scan.time_increment = 0.01F;
  auto back = laserScan("laser", {1, 2, 3, 4, 5});
  back.time_increment = -0.01F;  // from the last beam to the first, which is the stamp's
  FakeBag bag;
  bag.add("/scan", bags::kLaserScanType, kRosStart_ns, scan);
  bag.add("/scan", bags::kLaserScanType, kRosStart_ns + 1000, scan);
  bag.add("/scan", bags::kLaserScanType, kRosStart_ns + 2000, back);
  const auto source = bag.open();
  const auto objects = readAll(*source);
  ASSERT_EQ(objects.size(), 5U);  // the second scan is swept as the first
  const auto noteAt = [&](size_t i) {
    const auto comment = std::dynamic_pointer_cast<mrpt::obs::CObservationComment>(objects[i]);
    return comment ? objects::parseSweepNote(comment->text) : std::nullopt;
  };
  ASSERT_TRUE(noteAt(0) && noteAt(3));
  EXPECT_EQ(noteAt(0)->label, "scan");
  EXPECT_NEAR(noteAt(0)->sweep.duration_s, 0.04, 1e-6);
  EXPECT_TRUE(noteAt(0)->sweep.clockwise);
  EXPECT_EQ(noteAt(0)->sweep.stamped_share, 0);
  EXPECT_TRUE(noteAt(3)->sweep.clockwise);
  EXPECT_EQ(noteAt(3)->sweep.stamped_share, 1);
}

}  // namespace
}  // namespace slam::logs
