// LogReader on logs of several lidars, and of lidars that turn.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libslam/core/error.h"
#include "libslam/logs/log_reader.h"
#include "libslam/logs/log_writer.h"
#include "libslam/testing/temp_folder.h"

namespace slam::logs {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kStart_s = 1.7e9, kPeriod_s = 0.1;
const core::Pose2 kFront{0.2, 0, 0}, kRear{-0.2, 0, core::kPi};

lidar::Scan scanAt(double time_s, const core::Pose2& mount, float range_m) {
  lidar::Scan scan;
  scan.time_s = time_s;
  scan.step_rad = core::degToRad(1);
  scan.first_angle_rad = -core::degToRad(2);
  scan.max_range_m = 20;
  scan.T_robot_lidar = mount;
  for (int i = 0; i < 5; ++i) scan.ranges_m.push_back(range_m + 0.1F * static_cast<float>(i));
  return scan;
}

/// What differs between the logs below.
struct Given {
  core::Pose2 rear = kRear;
  double rear_later_s = 0;  ///< its stamps against the front's
  bool is_copy = false;     ///< the rear repeats the front's readings
  bool is_together = true;  ///< in one entry
  std::optional<lidar::Sweep> sweep = {};
  rawlogs::RawlogForm form = rawlogs::RawlogForm::kActionFrame;
};

/// Ten steps of 0.1 m, a scan to the front and one to the rear at each.
std::string writeTwo(const testing::TempFolder& folder, const Given& given) {
  std::string path = folder / "two.rawlog";
  LogWriter writer(path, given.form);
  for (int i = 0; i < 10; ++i) {
    const double time_s = kStart_s + i * kPeriod_s;
    const float range_m = 3 + 0.01F * static_cast<float>(i);
    LogEntry entry{scanAt(time_s, kFront, range_m), {0.1 * i, 0, 0}, {i > 0 ? 0.1 : 0.0, 0, 0}, true};
    entry.lidar = "front";
    entry.sweep = given.sweep;
    LidarScan rear{
        "rear", scanAt(time_s + given.rear_later_s, given.rear, given.is_copy ? range_m : range_m + 2), {}};
    if (given.is_together) entry.others.push_back(rear);
    writer.write(entry);
    if (given.is_together) continue;
    LogEntry later{rear.scan, entry.T_odom_robot, {}, false};
    later.lidar = "rear";
    writer.write(later);
  }
  writer.close();
  return path;
}

std::vector<LogEntry> readAll(LogReader& reader) {
  std::vector<LogEntry> entries;
  while (auto entry = reader.next()) entries.push_back(std::move(*entry));
  return entries;
}

TEST(SeveralLidars, OneMomentIsOneEntryInEitherForm) {
  for (const auto form : {rawlogs::RawlogForm::kActionFrame, rawlogs::RawlogForm::kObservationOnly}) {
    const testing::TempFolder folder;
    Given given;
    given.form = form;
    LogReader reader(writeTwo(folder, given), kAllLidars);
    const auto entries = readAll(reader);
    EXPECT_THAT(reader.lidars(), ElementsAre("front", "rear"));
    EXPECT_THAT(reader.remarks(), IsEmpty());
    ASSERT_EQ(entries.size(), 10U);
    for (const auto& entry : entries) {
      EXPECT_EQ(entry.lidar, "front");
      EXPECT_NEAR(entry.scan.T_robot_lidar.x, 0.2, 1e-6);
      ASSERT_EQ(entry.others.size(), 1U);
      EXPECT_EQ(entry.others[0].lidar, "rear");
      EXPECT_NEAR(entry.others[0].scan.T_robot_lidar.x, -0.2, 1e-6);
      EXPECT_TRUE(entry.has_odometry);
    }
    EXPECT_NEAR(entries.back().T_odom_robot.x, 0.9, 1e-6);
  }
}

TEST(SeveralLidars, TheMainOneAloneAndNamedOnes) {
  const testing::TempFolder folder;
  const auto path = writeTwo(folder, {});
  LogReader main(path), rear(path, "rear"), both(path, "rear,front");
  for (const auto& entry : readAll(main)) EXPECT_TRUE(entry.lidar == "front" && entry.others.empty());
  const auto of_rear = readAll(rear);
  EXPECT_EQ(of_rear.size(), 10U);
  // The motion of the scans passed over goes to the next one kept.
  EXPECT_NEAR(of_rear.back().T_odom_robot.x, 0.9, 1e-6);
  for (const auto& entry : readAll(both)) EXPECT_TRUE(entry.lidar == "rear" && entry.others.size() == 1);
  LogReader missing(path, "front,left");
  EXPECT_THROW(readAll(missing), core::InputError);
}

TEST(SeveralLidars, ScansOfTheirOwnTimesAreEntriesOfTheirOwn) {
  const testing::TempFolder folder;
  Given given;
  given.is_together = false;
  given.rear_later_s = 0.05;
  LogReader reader(writeTwo(folder, given), kAllLidars);
  const auto entries = readAll(reader);
  ASSERT_EQ(entries.size(), 20U);
  for (size_t i = 0; i < 20; ++i) {
    EXPECT_EQ(entries[i].lidar, i % 2 == 0 ? "front" : "rear");
    EXPECT_EQ(entries[i].has_odometry, i % 2 == 0);
    EXPECT_TRUE(entries[i].others.empty());
  }
}

TEST(SeveralLidars, WhatCannotBeTakenBesideTheMainOneIsPassedOver) {
  const auto remarkOf = [](const Given& given) {
    const testing::TempFolder folder;
    LogReader reader(writeTwo(folder, given), kAllLidars);
    const auto entries = readAll(reader);
    EXPECT_THAT(reader.lidars(), ElementsAre("front"));
    EXPECT_EQ(entries.size(), 10U);
    return reader.remarks().size() == 1 ? reader.remarks().front() : "";
  };
  Given given;
  given.is_copy = true;
  EXPECT_EQ(remarkOf(given), "lidar 'rear' is passed over: it repeats the readings of 'front'");
  given = {};
  given.rear = kFront;
  EXPECT_EQ(remarkOf(given), "lidar 'rear' is passed over: the log says that it is mounted where 'front' is");
  given.rear = {-3, 0, 0};
  EXPECT_THAT(remarkOf(given), HasSubstr("its mounting x -3.00 m, y 0.00 m is outside of any robot"));
  given = {};
  given.is_together = false;
  given.rear_later_s = -4;
  EXPECT_THAT(remarkOf(given), HasSubstr("the stamps of lidar 'rear' are 4.000 s before those of 'front'"));
}

TEST(SeveralLidars, NamedOnesWhoseStampsDisagreeAreRefused) {
  const testing::TempFolder folder;
  Given given;
  given.is_together = false;
  given.rear_later_s = 4;
  const auto path = writeTwo(folder, given);
  LogReader reader(path, "front,rear");
  try {
    reader.next();
    FAIL() << "expected an InputError";
  } catch (const core::InputError& error) {
    EXPECT_EQ(
        error.what(),
        path + ": the stamps of lidar 'rear' are 4.000 s after those of 'front' beside them in the log");
  }
}

TEST(SeveralLidars, TheLogStatesWhoseScansAreSwept) {
  for (const auto form : {rawlogs::RawlogForm::kActionFrame, rawlogs::RawlogForm::kObservationOnly}) {
    const testing::TempFolder folder;
    Given given;
    given.form = form;
    given.sweep = lidar::Sweep{0.05, true, 0.5};
    LogReader reader(writeTwo(folder, given), kAllLidars);
    for (const auto& entry : readAll(reader)) {
      ASSERT_TRUE(entry.sweep);
      EXPECT_EQ(entry.sweep->duration_s, 0.05);
      EXPECT_TRUE(entry.sweep->clockwise);
      EXPECT_EQ(entry.sweep->stamped_share, 0.5);
      EXPECT_FALSE(entry.others.at(0).sweep);
    }
  }
}

TEST(SeveralLidars, ASweepLongerThanThePeriodIsNotBelieved) {
  const testing::TempFolder folder;
  Given given;
  given.sweep = lidar::Sweep{0.3};
  LogReader reader(writeTwo(folder, given));
  for (const auto& entry : readAll(reader)) EXPECT_FALSE(entry.sweep);
  EXPECT_THAT(reader.remarks(),
              ElementsAre("lidar 'front': the log states a sweep of 0.3 s, longer than the 0.1 s between two "
                          "scans: the scans are taken as they are"));
}

}  // namespace
}  // namespace slam::logs
