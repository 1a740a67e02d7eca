#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"
#include "tests/logs/ros_fixtures.h"

#ifdef RASTERSLAM_HAS_ROSBAG
#include <geometry_msgs/PoseStamped.h>
#include <nav_msgs/Odometry.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/MultiEchoLaserScan.h>
#include <tf2_msgs/TFMessage.h>
#endif

// ROS's own library (librosbag) against our reader and writer.

namespace slam::logs {
namespace {

using mrpt::obs::CObservation2DRangeScan;
using mrpt::obs::CObservationOdometry;
using ::testing::HasSubstr;

TEST(Ros1Bag, NamesTheVersionOfAnOlderBag) {
  const testing::TempFolder folder;
  writeBytes("#ROSBAG V1.2\nversion=1.2\n", folder / "old.bag");
  EXPECT_EQ(
      testing::errorOf([&] { bags::openRos1Bag(folder / "old.bag"); }),
      (folder / "old.bag") + ": a ROS bag of version 1.2, expected 2.0 (`rosbag migrate` turns it into one)");
}

TEST(Ros1Bag, ReadsABagThatItsRecorderDidNotCloseThenSaysSo) {
  const testing::TempFolder folder;
  const auto path = folder / "log.bag";
  writeAll(drive(5), *bags::createRos1Bag(path));
  auto bytes = readBytes(path);
  // As a recorder leaves it: without the index, whose place the bag's header does not know yet.
  const auto index_pos = bytes.find("index_pos=") + 10;
  std::uint64_t position = 0;
  std::memcpy(&position, bytes.data() + index_pos, sizeof position);
  bytes.resize(position);
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(index_pos), 8, '\0');
  writeBytes(bytes, path);
  const auto source = bags::openRos1Bag(path);
  const auto error = testing::errorOf([&] { readAll(*source); });
  EXPECT_EQ(source->count(), 15U);
  EXPECT_THAT(error,
              HasSubstr("its recorder did not close it: it has no index (`rosbag reindex` makes one)"));
}

#ifdef RASTERSLAM_HAS_ROSBAG

TEST(Ros1Bag, IsReadByRosbag) {
  const testing::TempFolder folder;
  const auto path = folder / "log.bag";
  writeAll(drive(3000), *bags::createRos1Bag(path));

  rosbag::Bag bag(path, rosbag::bagmode::Read);
  EXPECT_EQ(bag.getMajorVersion(), 2U);
  rosbag::View view(bag);
  std::map<std::string, size_t> counts;
  size_t scans = 0, moments = 0;
  for (const rosbag::MessageInstance& message : view) {
    ++counts[message.getTopic()];
    if (const auto scan = message.instantiate<sensor_msgs::LaserScan>()) {
      EXPECT_EQ(message.getTopic(), "/scan");
      EXPECT_EQ(scan->header.stamp.toNSec(), static_cast<std::uint64_t>(kRosStart_ns) + 200'000'000U * scans);
      EXPECT_EQ(scan->header.frame_id, "laser");
      ASSERT_EQ(scan->ranges.size(), 7U);
      EXPECT_EQ(scan->ranges[0], 1.1F + 0.001F * static_cast<float>(scans));
      EXPECT_EQ(scan->ranges[2], kInf);
      EXPECT_TRUE(std::isnan(scan->ranges[3]));
      EXPECT_EQ(scan->range_max, 30);
      EXPECT_EQ(scan->angle_max - scan->angle_min, 3.1415927F);
      ++scans;
    } else if (const auto odometry = message.instantiate<nav_msgs::Odometry>()) {
      EXPECT_EQ(odometry->pose.pose.position.x, 0.1 * static_cast<double>(moments));
      EXPECT_EQ(odometry->child_frame_id, "base_link");
      ++moments;
    } else if (const auto transforms = message.instantiate<tf2_msgs::TFMessage>()) {
      ASSERT_EQ(transforms->transforms.size(), 1U);
      if (message.getTopic() == "/tf_static") {
        EXPECT_EQ(transforms->transforms[0].child_frame_id, "laser");
        EXPECT_EQ(transforms->transforms[0].transform.translation.z, 0.3);
        EXPECT_EQ(message.isLatching(), true);
      }
    } else {
      EXPECT_TRUE(message.isType<geometry_msgs::PoseStamped>());
    }
  }
  const std::map<std::string, size_t> expected{
      {"/scan", 3000}, {"/odom", 3000}, {"/tf", 3000}, {"/tf_static", 1}, {"/ground_truth", 3000}};
  EXPECT_EQ(counts, expected);
  // The index serves queries too.
  rosbag::View part(bag, rosbag::TopicQuery("/scan"), ros::Time(1'700'000'100), ros::Time(1'700'000'200));
  EXPECT_EQ(part.size(), 500U);
}

TEST(Ros1Bag, HasTheDefinitionsAndSumsOfRos) {
  EXPECT_EQ(bags::rosMd5(bags::kLaserScanType), ros::message_traits::md5sum<sensor_msgs::LaserScan>());
  EXPECT_EQ(bags::rosMd5(bags::kMultiEchoType),
            ros::message_traits::md5sum<sensor_msgs::MultiEchoLaserScan>());
  EXPECT_EQ(bags::rosMd5(bags::kOdometryType), ros::message_traits::md5sum<nav_msgs::Odometry>());
  EXPECT_EQ(bags::rosMd5(bags::kPoseStampedType), ros::message_traits::md5sum<geometry_msgs::PoseStamped>());
  EXPECT_EQ(bags::rosMd5(bags::kTransformsType), ros::message_traits::md5sum<tf2_msgs::TFMessage>());
}

class RosbagCompression : public ::testing::TestWithParam<rosbag::compression::CompressionType> {};
INSTANTIATE_TEST_SUITE_P(Each, RosbagCompression,
                         ::testing::Values(rosbag::compression::Uncompressed, rosbag::compression::BZ2,
                                           rosbag::compression::LZ4));

TEST_P(RosbagCompression, IsReadByUs) {
  const testing::TempFolder folder;
  const auto path = folder / "log.bag";
  constexpr int kScans = 400;
  {
    rosbag::Bag bag(path, rosbag::bagmode::Write);
    bag.setCompression(GetParam());
    bag.setChunkThreshold(20'000);
    for (int i = 0; i < kScans; ++i) {
      const ros::Time now(1'500'000'000 + static_cast<unsigned>(i), 5'000);
      sensor_msgs::LaserScan scan;
      scan.header.stamp = now;
      scan.header.seq = static_cast<unsigned>(i);
      scan.header.frame_id = "/laser";
      scan.angle_min = -1;
      scan.angle_max = 1;
      scan.angle_increment = 2.0F / 180;
      scan.range_max = 20;
      for (int k = 0; k < 181; ++k) scan.ranges.push_back(0.01F * static_cast<float>(k * i % 1999 + 1));
      nav_msgs::Odometry odometry;
      odometry.header.stamp = now;
      odometry.child_frame_id = "base_link";
      odometry.pose.pose.position.x = 0.25 * i;
      odometry.pose.pose.orientation.w = 1;
      bag.write("/odom", now, odometry);
      bag.write("/lidar/scan", now, scan);
    }
    bag.close();
  }
  const auto source = bags::openRos1Bag(path);
  const auto objects = readAll(*source);
  const auto scans = only<CObservation2DRangeScan>(objects);
  const auto odometry = only<CObservationOdometry>(objects);
  ASSERT_EQ(scans.size(), static_cast<size_t>(kScans));
  ASSERT_EQ(odometry.size(), static_cast<size_t>(kScans));
  for (int i = 0; i < kScans; ++i) {
    const auto& scan = *scans[static_cast<size_t>(i)];
    EXPECT_EQ(scan.sensorLabel, "lidar/scan");
    EXPECT_EQ(stampNs(scan), (1'500'000'000LL + i) * 1'000'000'000 + 5'000);
    for (int k = 0; k < 181; ++k)
      ASSERT_EQ(scan.getScanRange(static_cast<size_t>(k)), 0.01F * static_cast<float>(k * i % 1999 + 1));
    EXPECT_EQ(odometry[static_cast<size_t>(i)]->odometry.x(), 0.25 * i);
  }
}

TEST(Ros1Bag, OfAnotherDefinitionIsRefused) {
  const testing::TempFolder folder;
  const auto path = folder / "log.bag";
  writeAll(drive(1), *bags::createRos1Bag(path));
  auto bytes = readBytes(path);
  const std::string sum = bags::rosMd5(bags::kOdometryType);
  for (size_t at = bytes.find(sum); at != std::string::npos; at = bytes.find(sum, at + 1)) bytes[at] = '0';
  writeBytes(bytes, path);
  EXPECT_THAT(testing::errorOf([&] { readAll(*bags::openRos1Bag(path)); }),
              HasSubstr("(/odom): nav_msgs/Odometry: a definition with the MD5 sum 0"));
}

#else

TEST(Ros1Bag, IsReadByRosbag) {
  GTEST_SKIP() << "this test was built without librosbag (Debian: librosbag-storage-dev, libsensor-msgs-dev, "
                  "libnav-msgs-dev, "
                  "libtf2-msgs-dev)";
}

#endif

}  // namespace
}  // namespace slam::logs
