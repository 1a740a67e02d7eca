#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/obs/CObservationComment.h>

#include <filesystem>

#include "libslam/files/files.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"
#include "tests/logs/ros_fixtures.h"

namespace slam::logs {
namespace {

using mrpt::obs::CObservation2DRangeScan;
using mrpt::obs::CObservationOdometry;
using mrpt::obs::CObservationRobotPose;

class RosContainer : public ::testing::TestWithParam<Container> {
 protected:
  void write(const std::vector<Object>& objects) {
    const auto sink = GetParam().create(path());
    writeAll(objects, *sink);
    dropped_ = sink->dropped();
  }
  std::vector<Object> read() {
    const auto source = GetParam().open(path());
    auto objects = readAll(*source);
    skipped_ = source->skipped();
    return objects;
  }
  std::string path() const { return folder_ / GetParam().file; }

  testing::TempFolder folder_;
  std::string dropped_, skipped_;
};

INSTANTIATE_TEST_SUITE_P(Each, RosContainer, ::testing::ValuesIn(containers()),
                         [](const auto& parameter) { return parameter.param.name; });

void expectSameScan(const CObservation2DRangeScan& found, const CObservation2DRangeScan& expected) {
  EXPECT_EQ(found.timestamp, expected.timestamp);
  EXPECT_EQ(found.aperture, expected.aperture);
  EXPECT_EQ(found.maxRange, expected.maxRange);
  EXPECT_EQ(found.rightToLeft, expected.rightToLeft);
  EXPECT_EQ(found.sensorPose.x(), expected.sensorPose.x());
  EXPECT_EQ(found.sensorPose.y(), expected.sensorPose.y());
  EXPECT_EQ(found.sensorPose.z(), expected.sensorPose.z());
  EXPECT_NEAR(found.sensorPose.yaw(), expected.sensorPose.yaw(), 1e-15);
  ASSERT_EQ(found.getScanSize(), expected.getScanSize());
  for (size_t i = 0; i < found.getScanSize(); ++i) {
    EXPECT_EQ(found.getScanRange(i), expected.getScanRange(i)) << i;
    EXPECT_EQ(found.getScanRangeValidity(i), expected.getScanRangeValidity(i)) << i;
  }
}

TEST_P(RosContainer, GivesBackWhatWasWritten) {
  const auto written = drive(500);
  write(written);
  const auto found = read();
  EXPECT_EQ(dropped_, "");
  EXPECT_EQ(skipped_, "");
  ASSERT_EQ(found.size(), written.size());
  for (size_t i = 0; i < found.size(); i += 3) {
    const auto& odometry = dynamic_cast<const CObservationOdometry&>(*found[i]);
    const auto& odometry_written = dynamic_cast<const CObservationOdometry&>(*written[i]);
    EXPECT_EQ(odometry.timestamp, odometry_written.timestamp);
    EXPECT_EQ(odometry.odometry.x(), odometry_written.odometry.x());
    EXPECT_EQ(odometry.odometry.y(), odometry_written.odometry.y());
    // A quaternion holds a yaw to a bit or two.
    EXPECT_NEAR(odometry.odometry.phi(), odometry_written.odometry.phi(), 1e-15);
    const auto& truth = dynamic_cast<const CObservationRobotPose&>(*found[i + 1]);
    const auto& truth_written = dynamic_cast<const CObservationRobotPose&>(*written[i + 1]);
    EXPECT_EQ(truth.timestamp, truth_written.timestamp);
    EXPECT_EQ(truth.sensorLabel, objects::kTruthLabel);
    EXPECT_EQ(truth.pose.mean.x(), truth_written.pose.mean.x());
    EXPECT_NEAR(truth.pose.mean.yaw(), truth_written.pose.mean.yaw(), 1e-15);
    expectSameScan(dynamic_cast<const CObservation2DRangeScan&>(*found[i + 2]),
                   dynamic_cast<const CObservation2DRangeScan&>(*written[i + 2]));
  }
}

TEST_P(RosContainer, KeepsTheOrderOfStampsThatRunBackOrRepeat) {
  std::vector<Object> written;
  for (const int tenths : {5, 3, 3, 9, 1})
    written.push_back(
        scanObject(kRosStart_ns + std::int64_t{100'000'000} * tenths, "scan", static_cast<float>(tenths)));
  write(written);
  const auto found = only<CObservation2DRangeScan>(read());
  ASSERT_EQ(found.size(), written.size());
  for (size_t i = 0; i < found.size(); ++i)
    expectSameScan(*found[i], dynamic_cast<const CObservation2DRangeScan&>(*written[i]));
}

TEST_P(RosContainer, KeepsAStartAtTimeZero) {
  write({scanObject(0, "scan"), scanObject(200'000'000, "scan")});
  const auto found = only<CObservation2DRangeScan>(read());
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(stampNs(*found[0]), 0);
  EXPECT_EQ(stampNs(*found[1]), 200'000'000);
}

TEST_P(RosContainer, GivesEachLabelItsTopicAndMounting) {
  auto left = scanObject(kRosStart_ns, "LEFT (1)"), front = scanObject(kRosStart_ns, "front/scan");
  auto right = scanObject(kRosStart_ns, "RIGHT 2");
  front->sensorPose = mrpt::poses::CPose3D(1, 2, 3, 0.4, 0.05, -0.06);
  right->sensorPose = mrpt::poses::CPose3D(0, 0, 0, -2, 0, 0);
  write({left, front, right, left});
  const auto found = only<CObservation2DRangeScan>(read());
  ASSERT_EQ(found.size(), 4U);
  EXPECT_EQ(found[0]->sensorLabel, "scan");
  EXPECT_EQ(found[1]->sensorLabel, "front/scan");
  EXPECT_EQ(found[2]->sensorLabel, "scan_RIGHT_2");
  EXPECT_EQ(found[3]->sensorLabel, "scan");
  expectSameScan(*found[3], *left);
  expectSameScan(*found[2], *right);
  EXPECT_NEAR(found[1]->sensorPose.yaw(), 0.4, 1e-12);
  EXPECT_NEAR(found[1]->sensorPose.pitch(), 0.05, 1e-12);
  EXPECT_NEAR(found[1]->sensorPose.roll(), -0.06, 1e-12);
}

TEST_P(RosContainer, WritesSweepsFromLeftToRightTheRosWayRound) {
  auto scan = scanObject(kRosStart_ns, "scan");
  scan->rightToLeft = false;
  write({scan});
  const auto found = only<CObservation2DRangeScan>(read());
  EXPECT_TRUE(found.at(0)->rightToLeft);
  EXPECT_EQ(found[0]->getScanRange(6), 1.1F);
  EXPECT_EQ(found[0]->getScanRange(5), 2.2F);
}

TEST_P(RosContainer, KeepsIntensities) {
  auto scan = scanObject(kRosStart_ns, "scan");
  scan->setScanHasIntensity(true);
  for (size_t i = 0; i < scan->getScanSize(); ++i) scan->setScanIntensity(i, 100 + static_cast<int>(i));
  write({scan});
  const auto found = only<CObservation2DRangeScan>(read());
  ASSERT_TRUE(found.at(0)->hasIntensity());
  EXPECT_EQ(found[0]->getScanIntensity(6), 106);
}

TEST_P(RosContainer, CountsWhatItCannotHold) {
  auto comment = std::make_shared<mrpt::obs::CObservationComment>();
  auto estimate = truthObject(kRosStart_ns, 1);
  estimate->sensorLabel = "ESTIMATE";
  auto ancient = scanObject(-1'000'000'000, "scan");
  auto unstamped = scanObject(kRosStart_ns, "scan");
  unstamped->timestamp = mrpt::Clock::time_point();
  auto frame = std::make_shared<mrpt::obs::CSensoryFrame>();
  write({frame, comment, estimate, ancient, unstamped, scanObject(kRosStart_ns, "scan"), unstamped, comment});
  EXPECT_EQ(dropped_,
            "2 mrpt::obs::CObservationComment, 1 mrpt::obs::CObservationRobotPose, 1 "
            "mrpt::obs::CSensoryFrame, 2 without a stamp that ROS can "
            "hold");
  const auto found = only<CObservation2DRangeScan>(read());
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(stampNs(*found[1]), kRosStart_ns);
}

std::string bytesBelow(const std::string& path) {
  if (!std::filesystem::is_directory(path)) return readBytes(path);
  std::string bytes;
  for (const char* name : {"log_0.db3", "metadata.yaml"})
    bytes += readBytes((std::filesystem::path(path) / name).string());
  return bytes;
}

TEST_P(RosContainer, WritesTheSameBytesAgain) {
  write(drive(50));
  const auto first = bytesBelow(path());
  std::filesystem::remove_all(path());
  write(drive(50));
  EXPECT_EQ(bytesBelow(path()), first);
}

TEST_P(RosContainer, LeavesNothingBehindWithoutClose) {
  {
    const auto sink = GetParam().create(path());
    for (const auto& object : drive(3)) sink->write(*object);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_P(RosContainer, LeavesTheFileThatItReadsAsItIs) {
  write(drive(20));
  const auto before = bytesBelow(path());
  read();
  EXPECT_EQ(bytesBelow(path()), before);
  size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path()))
    if (entry.is_regular_file()) ++files;
  EXPECT_EQ(files, std::filesystem::is_directory(path()) ? 2U : 1U);
}

TEST_P(RosContainer, SaysThatABagHoldsNoMessages) {
  write({});
  EXPECT_THAT(testing::errorOf([&] { read(); }), ::testing::HasSubstr(": holds no messages, expected"));
}

}  // namespace
}  // namespace slam::logs
