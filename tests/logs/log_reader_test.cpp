#include "libslam/logs/log_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/obs/CActionRobotMovement3D.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/poses/CPosePDFGaussian.h>

#include <limits>

#include "libslam/testing/temp_folder.h"
#include "tests/logs/log_fixtures.h"

namespace slam::logs {
namespace {

using mrpt::obs::CActionRobotMovement2D;
using ::testing::ElementsAre;

std::vector<double> travelled(const std::vector<LogEntry>& entries) {
  std::vector<double> x_m;
  for (const auto& entry : entries) x_m.push_back(entry.T_odom_robot.x);
  return x_m;
}

std::vector<bool> measured(const std::vector<LogEntry>& entries) {
  std::vector<bool> flags;
  for (const auto& entry : entries) flags.push_back(entry.has_odometry);
  return flags;
}

CActionRobotMovement2D matchedAction(double x_m) {
  CActionRobotMovement2D action;
  action.timestamp = mrptTime(kStart_s);
  action.estimationMethod = CActionRobotMovement2D::emScan2DMatching;
  action.poseChange = mrpt::poses::CPosePDFGaussian::Create(mrpt::poses::CPose2D(x_m, 0, 0),
                                                            mrpt::math::CMatrixDouble33::Identity());
  return action;
}

mrpt::obs::CActionRobotMovement3D spatialAction(double x_m) {
  mrpt::obs::CActionRobotMovement3D action;
  action.timestamp = mrptTime(kStart_s);
  action.poseChange.mean = mrpt::poses::CPose3D(x_m, 0, 0, 0, 0, 0);
  return action;
}

// --- What is in the log ---------------------------------------------------------------------------------

TEST(LogReader, ReadsAPlainLogAsThePackedOne) {
  const testing::TempFolder folder;
  writeLog(sampleEntries(9), folder / "packed.rawlog", rawlogs::RawlogForm::kActionFrame);
  writeBytes(unpacked(folder / "packed.rawlog"), folder / "plain.rawlog");
  const auto plain = readLog(folder / "plain.rawlog"), packed = readLog(folder / "packed.rawlog");
  ASSERT_EQ(plain.size(), 9U);
  EXPECT_EQ(travelled(plain), travelled(packed));
}

TEST(LogReader, ReadsSeveralGzipMembersInARow) {
  const testing::TempFolder folder;
  writeLog(sampleEntries(3), folder / "a.rawlog", rawlogs::RawlogForm::kActionFrame);
  const auto bytes = readBytes(folder / "a.rawlog");
  writeBytes(bytes + bytes, folder / "twice.rawlog");
  EXPECT_EQ(readLog(folder / "twice.rawlog").size(), 6U);
}

// Before MRPT 0.5.5: the length of the name and the version in four bytes each, and no mark at the end.
TEST(LogReader, ReadsScansInTheLayoutOfOldLogs) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    log << rawScan(kStart_s, "L");
  }
  const auto plain = unpacked(folder / "a.rawlog");
  const size_t length = plain[0] & 0x7F;
  const std::string zeros(3, '\0'), name = plain.substr(1, length);
  writeBytes(static_cast<char>(length) + zeros + name + plain[1 + length] + zeros +
                 plain.substr(2 + length, plain.size() - length - 3),
             folder / "old.rawlog");
  const auto entries = readLog(folder / "old.rawlog");
  ASSERT_EQ(entries.size(), 1U);
  EXPECT_EQ(entries[0].scan.ranges_m, std::vector<float>(5, 2.0F));
}

TEST(LogReader, SkipsAndCountsWhatIsNeitherScanNorOdometry) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "frames.rawlog");
    log << commentSaying("hello") << collection(wheelAction(kStart_s, 0))
        << frame(mrpt::obs::CObservationImage(), rawScan(kStart_s, "L"), mrpt::obs::CObservationIMU())
        << commentSaying("between") << collection(wheelAction(kStart_s, 1))
        << frame(mrpt::obs::CObservationIMU()) << collection(wheelAction(kStart_s, 2))
        << frame(rawScan(kStart_s + 1, "L"));
  }
  LogReader reader(folder / "frames.rawlog");
  EXPECT_EQ(reader.next()->T_odom_robot.x, 0);
  EXPECT_EQ(reader.next()->T_odom_robot.x, 3) << "the motion before a frame without a scan is lost";
  EXPECT_FALSE(reader.next());
  EXPECT_FALSE(reader.next()) << "the end stays the end";
  EXPECT_EQ(reader.counts().entries, 8U);
  EXPECT_EQ(reader.counts().odometry_readings, 3U);
  EXPECT_EQ(reader.counts().other_observations, 5U);
  EXPECT_EQ(reader.fractionRead(), 1);

  {
    RawObjects log(folder / "bare.rawlog");
    log << mrpt::obs::CObservationIMU() << rawOdometry(kStart_s, 5) << mrpt::obs::CObservationImage()
        << rawScan(kStart_s, "L") << commentSaying("end");
  }
  LogReader bare(folder / "bare.rawlog");
  EXPECT_TRUE(bare.next()->has_odometry);
  EXPECT_FALSE(bare.next());
  EXPECT_EQ(bare.counts().other_observations, 3U);
}

TEST(LogReader, PrefersWheelOdometryToScanMatchingToSpatialActions) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    auto add = [&log, time_s = kStart_s](const mrpt::obs::CActionCollection& actions) mutable {
      log << actions << frame(rawScan(time_s += 1, "L"));
    };
    add(collection(wheelAction(kStart_s, 100)));  // before the first scan: dropped
    add(collection(matchedAction(8), spatialAction(16), wheelAction(kStart_s, 1)));
    add(collection(spatialAction(16), matchedAction(2)));
    add(collection(spatialAction(4)));
    add(collection());
  }
  const auto entries = readLog(folder / "a.rawlog");
  EXPECT_THAT(travelled(entries), ElementsAre(0, 1, 3, 7, 7));
  EXPECT_THAT(measured(entries), ElementsAre(true, true, true, true, false));
  EXPECT_EQ(entries[4].T_previous_robot.x, 0);
}

TEST(LogReader, ComposesSeveralActionsBeforeOneScan) {
  const testing::TempFolder folder;
  {
    auto quarter = wheelAction(kStart_s, 0);
    quarter.computeFromOdometry(mrpt::poses::CPose2D(1, 0, core::kPi / 2), {});
    RawObjects log(folder / "a.rawlog");
    log << frame(rawScan(kStart_s, "L")) << collection(quarter) << collection(quarter)
        << frame(rawScan(kStart_s + 1, "L"));
  }
  const auto entries = readLog(folder / "a.rawlog");
  EXPECT_THAT(measured(entries), ElementsAre(false, true));
  // 1 ahead, turn left, 1 ahead, turn left. Rounding of sin and cos.
  EXPECT_NEAR(entries[1].T_previous_robot.x, 1, 1e-15);
  EXPECT_NEAR(entries[1].T_previous_robot.y, 1, 1e-15);
  EXPECT_NEAR(std::abs(entries[1].T_previous_robot.phi), core::kPi, 1e-15);
}

TEST(LogReader, PairsABareScanWithTheNewestOdometryOfItsTime) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    log << rawScan(kStart_s, "L")  // before any odometry
        << rawOdometry(kStart_s + 0.5, 10)
        << rawScan(kStart_s + 1, "L")  // the first reading: no increment yet
        << rawOdometry(kStart_s + 1.2, 11) << rawOdometry(kStart_s + 1.8, 13)
        << rawOdometry(kStart_s + 2.5, 20) << rawScan(kStart_s + 2, "L")  // the last one is too late for it
        << rawScan(kStart_s + 2.2, "L")                                   // nothing new
        << rawScan(kStart_s + 2.5, "L");                                  // stamped equal: used
  }
  const auto entries = readLog(folder / "a.rawlog");
  EXPECT_THAT(measured(entries), ElementsAre(false, false, true, false, true));
  EXPECT_THAT(travelled(entries), ElementsAre(0, 0, 3, 3, 10));
}

TEST(LogReader, LetsNoReadingOfALaterStampBlockThoseAfterItInTheFile) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    log << rawOdometry(kStart_s + 1, 1)
        << rawScan(kStart_s + 1, "L")
        // The stamps run back by a second, then go on.
        << rawOdometry(kStart_s + 2, 2) << rawOdometry(kStart_s + 1.5, 4) << rawScan(kStart_s + 1.5, "L")
        << rawScan(kStart_s + 2, "L")  // nothing new: what it could have had was passed over
        << rawOdometry(kStart_s + 3, 9) << rawOdometry(kStart_s + 2.5, 5) << rawScan(kStart_s + 2.6, "L")
        << rawOdometry(kStart_s + 4, 12) << rawScan(kStart_s + 4, "L");
  }
  const auto entries = readLog(folder / "a.rawlog");
  EXPECT_THAT(measured(entries), ElementsAre(true, true, false, true, true));
  EXPECT_THAT(travelled(entries), ElementsAre(0, 3, 3, 4, 11));
}

TEST(LogReader, TakesTheFirstReadingForTheIdentityWhateverItSays) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    auto start = rawOdometry(kStart_s, 0), later = rawOdometry(kStart_s + 1, 0);
    start.odometry = mrpt::poses::CPose2D(4, 5, core::kPi / 2);
    later.odometry = mrpt::poses::CPose2D(4, 7, core::kPi / 2);
    log << start << rawScan(kStart_s, "L") << later << rawScan(kStart_s + 1, "L");
  }
  const auto entries = readLog(folder / "a.rawlog");
  EXPECT_THAT(measured(entries), ElementsAre(true, true));
  EXPECT_EQ(entries[0].T_odom_robot.x, 0);
  // The world's y is ahead of a robot that looks along it; rounding of sin and cos.
  EXPECT_NEAR(entries[1].T_odom_robot.x, 2, 1e-15);
  EXPECT_NEAR(entries[1].T_odom_robot.y, 0, 1e-15);
}

TEST(LogReader, FollowsTheFileWhenTheClocksOfOdometryAndLidarDoNotAgree) {
  const testing::TempFolder folder;
  constexpr int kScans = 1200;  // more than the reader lets wait
  {
    RawObjects log(folder / "a.rawlog");
    for (int i = 0; i < kScans; ++i)
      log << rawOdometry(kStart_s + 3600 + i, i) << rawScan(kStart_s + i, "L", 2);
  }
  const auto entries = readLog(folder / "a.rawlog");
  ASSERT_EQ(entries.size(), static_cast<size_t>(kScans));
  EXPECT_EQ(entries.back().T_odom_robot.x, kScans - 1 - 1000);
}

TEST(LogReader, TakesOdometryInsideAFrameForTheScansOfTheFrame) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    log << frame(rawScan(kStart_s, "L"), rawOdometry(kStart_s, 3)) << mrpt::obs::CActionCollection()
        << frame(rawScan(kStart_s + 1, "L"), rawOdometry(kStart_s + 1, 4));
  }
  EXPECT_THAT(travelled(readLog(folder / "a.rawlog")), ElementsAre(0, 1));
  EXPECT_THAT(measured(readLog(folder / "a.rawlog")), ElementsAre(true, true));
  EXPECT_EQ(inspectLog(folder / "a.rawlog").odometry_readings, 2U);
}

TEST(LogReader, CountsMotionOnceWhenALogHasActionsAndReadings) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    log << rawOdometry(kStart_s, 0);
    for (int i = 0; i < 4; ++i)
      log << collection(wheelAction(kStart_s + i, 1)) << rawOdometry(kStart_s + i, i)
          << frame(rawScan(kStart_s + i, "L"));
  }
  EXPECT_THAT(travelled(readLog(folder / "a.rawlog")), ElementsAre(0, 1, 2, 3));
}

// --- Several lidars -------------------------------------------------------------------------------------

void writeTwoLidars(const std::string& path) {
  RawObjects log(path);
  for (int i = 0; i < 6; ++i) {
    log << collection(wheelAction(kStart_s + i, 1));
    if (i % 2 == 0)
      log << frame(rawScan(kStart_s + i, "REAR"), rawScan(kStart_s + i, "FRONT", 9));
    else
      log << frame(rawScan(kStart_s + i, "FRONT", 9));
  }
}

TEST(LogReader, ChoosesTheLidarWithTheMostScans) {
  const testing::TempFolder folder;
  writeTwoLidars(folder / "a.rawlog");
  LogReader reader(folder / "a.rawlog");
  int scans = 0;
  while (const auto entry = reader.next()) {
    EXPECT_EQ(entry->scan.ranges_m.size(), 9U);
    EXPECT_EQ(entry->T_odom_robot.x, scans++);
  }
  EXPECT_EQ(scans, 6);
  EXPECT_EQ(reader.sensorLabel(), "FRONT");
  EXPECT_THAT(reader.counts().scans_by_label,
              ElementsAre(std::make_pair("FRONT", 6U), std::make_pair("REAR", 3U)));
}

TEST(LogReader, GivesTheNamedLidarWithTheMotionOfTheScansBetween) {
  const testing::TempFolder folder;
  writeTwoLidars(folder / "a.rawlog");
  EXPECT_THAT(travelled(readLog(folder / "a.rawlog", "REAR")), ElementsAre(0, 2, 4));
}

TEST(LogReader, TakesTheLidarMetFirstOfTwoEqualOnes) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    log << rawScan(kStart_s, "Z") << rawScan(kStart_s, "A") << rawScan(kStart_s + 1, "Z")
        << rawScan(kStart_s + 1, "A");
  }
  LogReader reader(folder / "a.rawlog");
  reader.next();
  EXPECT_EQ(reader.sensorLabel(), "Z");
}

TEST(LogReader, NamesTheLidarsThatAreThereWhenTheOneAskedForIsNot) {
  const testing::TempFolder folder;
  writeTwoLidars(folder / "a.rawlog");
  EXPECT_EQ(readOutcome(folder / "a.rawlog", "LASER").error,
            folder / "a.rawlog" +
                ": no laser scan with the sensor label 'LASER', found 'FRONT' (6 scans), 'REAR' (3 scans)");
}

// --- Stamps ---------------------------------------------------------------------------------------------

TEST(LogReader, GivesAScanWithoutAStampThatOfItsAction) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    log << collection(wheelAction(kStart_s + 0.25, 0)) << frame(rawScan(0, "L"));
    log << collection(wheelAction(kStart_s + 0.5, 0)) << frame(rawScan(0, "L"));
  }
  const auto entries = readLog(folder / "a.rawlog");
  EXPECT_EQ(entries[0].scan.time_s, kStart_s + 0.25);
  EXPECT_EQ(entries[1].scan.time_s, kStart_s + 0.5);
}

TEST(LogReader, RefusesAScanThatNothingGivesAStamp) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    log << rawOdometry(0, 1) << rawScan(0, "L");
  }
  EXPECT_EQ(readOutcome(folder / "a.rawlog").error,
            folder / "a.rawlog" +
                ": entry 2: laser scan without a time stamp, and no action or odometry before it has one");
}

}  // namespace
}  // namespace slam::logs
