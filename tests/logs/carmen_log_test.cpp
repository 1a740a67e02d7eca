// CARMEN lines, drawn small: what each becomes, and what is said of bad ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libslam/edit/convert.h"
#include "libslam/logs/log_format.h"
#include "libslam/logs/log_reader.h"
#include "libslam/objects/mrpt_time.h"
#include "tests/logs/carmen_fixtures.h"

namespace slam::logs {
namespace {

using mrpt::obs::CObservation2DRangeScan;
using mrpt::obs::CObservationComment;
using mrpt::obs::CObservationOdometry;
using mrpt::obs::CObservationRobotPose;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string kTail = " 1000.5 host 0.5\n";

/// A line of so many readings of 1 m.
std::string flaser(int readings, const std::string& kind = "FLASER",
                   const std::string& poses = "0 0 0 0 0 0") {
  std::string line = kind + " " + std::to_string(readings);
  for (int i = 0; i < readings; ++i) line += " 1.00";
  return line + " " + poses + kTail;
}

CObservation2DRangeScan::Ptr scanOf(const std::string& text) {
  const auto scans = all<CObservation2DRangeScan>(objectsOfText(text));
  return scans.empty() ? nullptr : scans.back();
}

double angleDeg(const CObservation2DRangeScan& scan, size_t beam) {
  return core::radToDeg(scan.sensorPose.yaw() + static_cast<double>(scan.getScanAngle(beam)));
}

double seconds(const mrpt::obs::CObservation& observation) {
  return objects::secondsFromMrptTicks(observation.timestamp.time_since_epoch().count());
}

constexpr double kFloatAngle_deg = 1e-4;  // MRPT keeps the aperture in a float

TEST(CarmenReader, GivesWhatALineHoldsInItsOrder) {
  const auto objects = objectsOfText(
      "# remark\n"
      "PARAM robot_frontlaser_offset 0.25 1000.1 host 0.1\n"
      "ODOM 1 2 3 0.5 0.25 0 1000.2 host 0.2\n"
      "FLASER 2 1.25 2.5 1.25 0 0 1 0 0 1000.3 host 0.3\n"
      "SYNC tag 1000.4 host 0.4\n");
  EXPECT_THAT(outline(objects), ElementsAre("CARMEN line: # remark",
                                            "CARMEN line: PARAM robot_frontlaser_offset 0.25 1000.1 host 0.1",
                                            "CARMEN note: host host", "ODOMETRY", "FLASER_ODOMETRY", "FLASER",
                                            "CARMEN line: SYNC tag 1000.4 host 0.4"));
  const auto odometry = all<CObservationOdometry>(objects);
  EXPECT_EQ(seconds(*odometry[0]), 1000.2);
  EXPECT_EQ(odometry[0]->odometry.x(), 1);
  EXPECT_EQ(odometry[0]->odometry.phi(), 3);
  EXPECT_TRUE(odometry[0]->hasVelocities);
  EXPECT_EQ(odometry[0]->velocityLocal.vx, 0.5);
  EXPECT_EQ(odometry[0]->velocityLocal.omega, 0.25);
  EXPECT_EQ(seconds(*odometry[1]), 1000.3);
  EXPECT_EQ(odometry[1]->odometry.x(), 1);
  const auto scan = all<CObservation2DRangeScan>(objects)[0];
  EXPECT_EQ(seconds(*scan), 1000.3);
  EXPECT_EQ(scan->getScanRange(0), 1.25F);
  EXPECT_EQ(scan->sensorPose.x(), 0.25);
  const auto comments = all<CObservationComment>(objects);
  EXPECT_EQ(seconds(*comments[0]), 1000.2) << "of the first message: icp-slam demands a stamp of everything";
  EXPECT_EQ(seconds(*comments[1]), 1000.2);
  EXPECT_EQ(seconds(*comments[3]), 1000.3) << "of the message before";
}

TEST(CarmenReader, GivesTextWithoutAnyMessageToo) {
  const auto objects = objectsOfText("# remark\nPARAM a b host 0\n");
  EXPECT_THAT(outline(objects), ElementsAre("CARMEN line: # remark", "CARMEN line: PARAM a b host 0"));
}

TEST(CarmenReader, SpreadsReadingsOneStepApartFromTheRight) {
  struct Case {
    int readings;
    double first_deg, last_deg;
  };
  for (const auto& c : std::vector<Case>{{180, -90, 89},
                                         {181, -90, 90},
                                         {360, -90, 89.5},
                                         {361, -90, 90},
                                         {401, -50, 50},
                                         {400, -50, 49.75},
                                         {541, -135, 135},
                                         {1081, -135, 135},
                                         {721, -90, 90},
                                         {3, -90, 90}}) {
    const auto scan = scanOf(flaser(c.readings));
    ASSERT_TRUE(scan);
    EXPECT_NEAR(angleDeg(*scan, 0), c.first_deg, kFloatAngle_deg) << c.readings;
    EXPECT_NEAR(angleDeg(*scan, scan->getScanSize() - 1), c.last_deg, kFloatAngle_deg) << c.readings;
    EXPECT_TRUE(scan->rightToLeft);
  }
}

TEST(CarmenReader, TakesStepFieldOfViewAndMaximumFromParameters) {
  const auto scan = scanOf(
      "PARAM laser_front_laser_resolution 0.25 host 0\n"
      "PARAM laser_front_laser_fov 60 host 0\n"
      "PARAM robot_front_laser_max 0.9 host 0\n" +
      flaser(241));
  EXPECT_NEAR(angleDeg(*scan, 0), -30, kFloatAngle_deg);
  EXPECT_NEAR(angleDeg(*scan, 240), 30, kFloatAngle_deg);
  EXPECT_EQ(scan->maxRange, 0.9F);
  EXPECT_FALSE(scan->getScanRangeValidity(0));
  // A parameter holds for what comes after it, and that of the rear laser for the rear laser.
  const auto before = scanOf(flaser(181) + "PARAM laser_front_laser_resolution 0.5 host 0\n");
  EXPECT_NEAR(angleDeg(*before, 180), 90, kFloatAngle_deg);
  const auto rear = scanOf("PARAM laser_rear_laser_resolution 0.5 host 0\n" + flaser(181));
  EXPECT_NEAR(angleDeg(*rear, 180), 90, kFloatAngle_deg);
}

TEST(CarmenReader, MountsTheRearLaserBackwardsWithTheSignThatThePosesShow) {
  for (const std::string poses : {"-0.3 0 3.141593 0 0 0", "0.3 0 3.141593 0 0 0"}) {
    const auto objects =
        objectsOfText("PARAM robot_rearlaser_offset 0.3 host 0\n" + flaser(181, "RLASER", poses));
    const auto scan = all<CObservation2DRangeScan>(objects).at(0);
    EXPECT_NEAR(scan->sensorPose.x(), poses[0] == '-' ? -0.3 : 0.3, 1e-9);
    EXPECT_NEAR(std::abs(scan->sensorPose.yaw()), core::kPi, 1e-6);
    EXPECT_TRUE(all<CObservationRobotPose>(objects).empty()) << "the pose is odometry and mounting";
  }
}

TEST(CarmenReader, KeepsTheValueOfNoReturnsAndMarksThem) {
  const auto scan = scanOf("FLASER 5 1.5 81.83 79.99 0.00 80.00 0 0 0 0 0 0" + kTail);
  const auto valid = [&scan](size_t i) { return scan->getScanRangeValidity(i); };
  EXPECT_TRUE(valid(0));
  EXPECT_FALSE(valid(1));
  EXPECT_TRUE(valid(2));
  EXPECT_FALSE(valid(3));
  EXPECT_FALSE(valid(4));
  EXPECT_EQ(scan->getScanRange(1), 81.83F);
}

TEST(CarmenReader, KeepsALaserPoseThatOdometryDoesNotExplain) {
  const auto objects = objectsOfText(flaser(2, "FLASER", "5 6 0.5 1 2 0.25"));
  const auto poses = all<CObservationRobotPose>(objects);
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_EQ(poses[0]->sensorLabel, "FLASER_POSE");
  EXPECT_EQ(poses[0]->pose.mean.x(), 5);
  EXPECT_EQ(all<CObservationOdometry>(objects)[0]->odometry.x(), 1);
}

TEST(CarmenReader, ReadsNewLaserLinesWithTheirOwnGeometry) {
  const std::string line =
      "ROBOTLASER1 0 -0.5 1.0 0.5 10.0 0.02 0 3 1.0 10.0 12.0 3 7.6 0 -2 1.1 2.0 0 1.0 2.0 0 0.3 0.1 0.4 0.5 "
      "0.6" +
      kTail;
  const auto objects = objectsOfText(line);
  EXPECT_THAT(
      outline(objects),
      ElementsAre("CARMEN note: host host", "CARMEN note: ROBOTLASER1 config 0 -0.5 1.0 0.5 10.0 0.02 0",
                  "CARMEN note: ROBOTLASER1 safety 0.4 0.5 0.6", "ROBOTLASER1_ODOMETRY", "ROBOTLASER1"));
  const auto scan = all<CObservation2DRangeScan>(objects)[0];
  EXPECT_EQ(scan->aperture, 1.0F);
  EXPECT_EQ(scan->maxRange, 10.0F);
  EXPECT_EQ(scan->stdError, 0.02F);
  EXPECT_NEAR(scan->sensorPose.x(), 0.1, 1e-9);
  EXPECT_NEAR(scan->sensorPose.yaw(), 0, 1e-9);
  EXPECT_TRUE(scan->getScanRangeValidity(0));
  EXPECT_FALSE(scan->getScanRangeValidity(1)) << "at the maximum";
  EXPECT_FALSE(scan->getScanRangeValidity(2));
  EXPECT_EQ(scan->getScanIntensity(0), 8);
  EXPECT_EQ(scan->getScanIntensity(2), -2);
  EXPECT_EQ(all<CObservationOdometry>(objects)[0]->velocityLocal.vx, 0.3);
}

TEST(CarmenReader, KeepsTheMountingOfNewLinesUntilTheyContradictIt) {
  const auto line = [](const std::string& laser_x) {
    return "ROBOTLASER2 0 -0.5 1 0.5 10 0.02 0 3 1 1 1 0 " + laser_x + " 0 3.1415 0 0 0 0 0 0 0 0" + kTail;
  };
  const auto scans =
      all<CObservation2DRangeScan>(objectsOfText(line("0.250012") + line("0.2507") + line("0.26")));
  EXPECT_NEAR(scans[0]->sensorPose.x(), 0.25, 1e-12);
  EXPECT_EQ(scans[1]->sensorPose.x(), scans[0]->sensorPose.x());
  EXPECT_NEAR(scans[2]->sensorPose.x(), 0.26, 1e-12);
  EXPECT_NEAR(std::abs(scans[0]->sensorPose.yaw()), 3.1415, 1e-9);
}

TEST(CarmenReader, ReadsRawLaserLines) {
  const auto scan = scanOf("RAWLASER3 0 -1 1 0.5 10.0 0.02 0 3 1.0 2.0 3.0 0" + kTail);
  EXPECT_EQ(scan->sensorLabel, "RAWLASER3");
  EXPECT_NEAR(angleDeg(*scan, 0), core::radToDeg(-1), kFloatAngle_deg);
}

TEST(CarmenReader, LabelsTheTruthAsTruth) {
  const auto objects = objectsOfText("TRUEPOS 1 2 0.5 1.1 2.1 0.6" + kTail);
  EXPECT_THAT(outline(objects),
              ElementsAre("CARMEN note: host host", "TRUEPOS_ODOMETRY", objects::kTruthLabel));
  EXPECT_EQ(all<CObservationRobotPose>(objects)[0]->pose.mean.y(), 2);
  EXPECT_EQ(all<CObservationOdometry>(objects)[0]->odometry.y(), 2.1);
}

TEST(CarmenReader, KeepsUnknownMessagesAsTextAndCountsThem) {
  const testing::TempFolder folder;
  files::writeFileAtomically(
      folder / "a.clf",
      "ODOM 0 0 0 0 0 0" + kTail + "NMEA-GGA 1 2\nSONAR 3\n\nSONAR 4\nFLASER 0 0 0 0 0 0 0" + kTail);
  const auto source = openLog(folder / "a.clf");
  while (source->next()) {
  }
  EXPECT_EQ(source->skipped(),
            "4 lines kept as text only (1 FLASER of fewer than 2 readings, 1 NMEA-GGA, 2 SONAR)");
  EXPECT_EQ(source->place(), "line 6");
  EXPECT_EQ(source->fractionRead(), 1);
}

TEST(CarmenReader, SaysWhatIsWrongInWhichLine) {
  const std::string good = "ODOM 0 0 0 0 0 0" + kTail;  // a note and a reading
  const auto errorOf = [&good](const std::string& line) {
    const auto [count, error] = failureOfText(good + line);
    EXPECT_EQ(count, 2U) << "what is good comes first";
    return error;
  };
  EXPECT_EQ(errorOf("ODOM 1 2 x 0 0 0" + kTail), ":2: found 'x', expected x y theta (a finite number)");
  EXPECT_EQ(errorOf("ODOM 1 2 nan 0 0 0" + kTail), ":2: found 'nan', expected x y theta (a finite number)");
  EXPECT_EQ(errorOf("ODOM 1 2\n"), ":2: found the end of the line, expected x y theta");
  EXPECT_EQ(errorOf("ODOM 1 2 3 0 0 0 1000.5\n"), ":2: found the end of the line, expected ipc_hostname");
  EXPECT_EQ(errorOf("ODOM 1 2 3 0 0 0 1000.5 host 0 7\n"), ":2: found '7', expected the end of the line");
  EXPECT_EQ(errorOf("ODOM 1 2 3 0 0 0 -5 host 0\n"),
            ":2: found '-5', expected ipc_timestamp (seconds since 1970, before the year 10000)");
  EXPECT_EQ(errorOf("FLASER 3 1 2 0 0 0 0 0 0 1000.5 host 0\n"),
            ":2: found 'host', expected ipc_timestamp (seconds since 1970, before the year 10000)")
      << "two readings for three: the pose slides into the ranges";
  EXPECT_EQ(errorOf("FLASER 9 1 2 a 0 0 0 0 0 0" + kTail), ":2: found 'a', expected range 3 of 9 (metres)");
  EXPECT_EQ(errorOf("FLASER 2 1 1e300 0 0 0 0 0 0" + kTail),
            ":2: found '1e300', expected range 2 of 2 (metres)");
  EXPECT_EQ(
      errorOf("FLASER 4000000000 1 2" + kTail),
      ":2: found '4000000000', expected the number of ranges (a whole number, at most as many as the line "
      "has)");
  EXPECT_EQ(errorOf("ROBOTLASER1 0 0 1 -0.5 10 0 0 2 1 1 0 0 0 0 0 0 0 0 0 0 0 0" + kTail),
            ":2: found a sweep of 2 ranges -0.5 rad apart from 0, expected at most one turn");
  EXPECT_EQ(errorOf("ROBOTLASER1 0 0 1 0.5 0 0 0 2 1 1 0 0 0 0 0 0 0 0 0 0 0 0" + kTail),
            ":2: found maximum_range 0, expected a number above 0");
  EXPECT_EQ(errorOf("PARAM robot_frontlaser_offset ten host 0\n"),
            ":2: parameter robot_frontlaser_offset: found 'ten', expected a number from -100 to 100");
  EXPECT_EQ(
      errorOf("FLASER 2 1 2 0 0 0 0 0 0 1000.5"),
      ":2: truncated: the last line has no newline, and found the end of the line, expected ipc_hostname");
  EXPECT_EQ(errorOf(std::string((1 << 20) + 1, 'x')),
            ":2: found a line of more than 1 MiB, expected shorter ones");
}

TEST(CarmenReader, GivesWhatComesBeforeTheEndOfPackedDataThatAreCut) {
  const testing::TempFolder folder;
  std::string text;
  for (int i = 0; i < 2000; ++i) text += "ODOM " + std::to_string(i * 31 % 977) + " 0 0 0 0 0" + kTail;
  for (const auto& packed : {gzip(text), xz(text)}) {
    files::writeFileAtomically(folder / "a", packed.substr(0, packed.size() / 2));
    const auto [count, error] = failureOf(folder / "a");
    EXPECT_GT(count, 100U);
    EXPECT_LT(count, 2000U);
    EXPECT_THAT(error, HasSubstr(": truncated: the "));
    EXPECT_THAT(error, HasSubstr("after " + std::to_string(count - 1) + " good lines"));
  }
  const auto whole = gzip(text);
  files::writeFileAtomically(folder / "a", whole.substr(0, whole.size() - 4));
  const auto [all_objects, cut_in_trailer] = failureOf(folder / "a");
  EXPECT_EQ(all_objects, 2001U) << "a note and every reading";
  EXPECT_THAT(cut_in_trailer, HasSubstr(": truncated: the gzip data end"));
  auto damaged = xz(text);
  damaged[damaged.size() / 2] ^= 1;
  files::writeFileAtomically(folder / "a", damaged);
  EXPECT_THAT(failureOf(folder / "a").second, HasSubstr(": corrupt: the xz data break"));
}

TEST(LogFormats, AreToldByContentWhateverTheName) {
  const testing::TempFolder folder;
  const auto formatOf = [&folder](const std::string& content) {
    files::writeFileAtomically(folder / "log.txt", content);
    return detectLogFormat(folder / "log.txt");
  };
  const std::string carmen = "# a remark\n\nNMEA-GGA what\nODOM 0 0 0 0 0 0" + kTail;
  for (const auto& packed : {carmen, gzip(carmen), bzip2(carmen), xz(carmen)})
    EXPECT_EQ(formatOf(packed), LogFormat::kCarmen);
  EXPECT_EQ(formatOf("#ROSBAG V2.0\n"), LogFormat::kRos1Bag);
  EXPECT_EQ(formatOf(std::string("SQLite format 3\0and so on", 25)), LogFormat::kRos2Db3);
  EXPECT_EQ(formatOf("\x89MCAP0\r\n"), LogFormat::kMcap);
  EXPECT_EQ(formatOf("\x9Emrpt::obs::CObservationComment and so on"), LogFormat::kRawlog);
  EXPECT_THROW(formatOf("FLASERS are nice\n"), core::InputError);
  EXPECT_THROW(formatOf("ODOM \x01\n"), core::InputError);
}

// --- The way back
// -------------------------------------------------------------------------------------------

std::string throughRawlog(const std::string& text, std::optional<rawlogs::RawlogForm> form = std::nullopt) {
  const testing::TempFolder folder;
  files::writeFileAtomically(folder / "a.clf", text);
  edit::LogConversion to_rawlog, to_carmen;
  to_rawlog.form = form;
  to_carmen.to = LogFormat::kCarmen;
  edit::convertLog(folder / "a.clf", folder / "a.rawlog", to_rawlog, core::silentProgress());
  edit::convertLog(folder / "a.rawlog", folder / "b.clf", to_carmen, core::silentProgress());
  return files::readTextFile(folder / "b.clf");
}

TEST(CarmenWriter, GivesEveryLineBackThatARawlogCanHold) {
  const std::string text =
      "# remark\n"
      "PARAM robot_frontlaser_offset -0.04 1000.000000 merci 0.1\n"
      "PARAM robot_rearlaser_offset 0.30 1000.000000 merci 0.1\n"
      "ODOM 1.000000 -2.000000 22.500000 0.500000 0.250000 0.125 1000.250000 merci 0.000000\n"
      "ODOM 1.000000 -2.000000 22.500000 0.500000 0.250000 0.000 1000.250000 merci 0.000000\n"
      "FLASER 3 1.23 81.83 0.00 0.960000 0.000000 0.000000 1.000000 0.000000 0.000000 1000.500000 merci "
      "0.250000\n"
      "FLASER 3 1.23 81.83 0.001 5.000000 6.000000 0.500000 1.000000 0.000000 0.000000 1000.250000 other "
      "0.000000\n"
      "RLASER 2 1.23 4.00 0.700000 0.000000 3.141593 1.000000 0.000000 0.000000 1000.500000 other 0.250000\n"
      "UNKNOWN message\n"
      "ROBOTLASER1 0 -0.6 1.0 0.5 10.0 0.02 0 3 1.000 10.500 2.250 3 5 6 7 1.100000 2.000000 0.000000 "
      "1.000000 "
      "2.000000 0.000000 0.300000 0.100000 0.4 0.5 0.6 1001.250000 other 1.000000\n"
      "RAWLASER2 0 -0.5 1.0 0.5 10.0 0.02 0 3 1.000 10.500 2.250 0 1001.250000 other 1.000000\n";
  EXPECT_EQ(throughRawlog(text), text);
}

TEST(CarmenWriter, KeepsScansAndStampsThroughTheActionForm) {
  const std::string scan = " 3 1.23 81.83 0.00 ", tail = " host ";
  const auto line = [&](const std::string& x, const std::string& stamp, const std::string& since) {
    const std::string pose = x + " 0.000000 0.000000 ";
    return "FLASER" + scan + pose + pose + stamp + tail + since + "\n";
  };
  const auto back =
      throughRawlog(line("0.000000", "1000.250000", "0.000000") + "ODOM 0.5 0 0 0 0 0 1000.3 host 0.05\n" +
                        line("0.750000", "1000.500000", "0.250000"),
                    rawlogs::RawlogForm::kActionFrame);
  // Odometry stands in lines of its own, and that between scans is in the increments.
  EXPECT_EQ(back,
            "ODOM 0.000000 0.000000 0.000000 0.000000 0.000000 0.000000 1000.250000 nohost 0.000000\n" +
                line("0.000000", "1000.250000", "0.000000") +
                "ODOM 0.750000 0.000000 0.000000 0.000000 0.000000 0.000000 1000.500000 host 0.250000\n" +
                line("0.750000", "1000.500000", "0.250000"));
}

TEST(CarmenWriter, WritesScansOfOtherLogsAsNewLinesThatReadBackTheSame) {
  const testing::TempFolder folder;
  CObservation2DRangeScan scan;
  scan.timestamp = mrpt::Clock::time_point(mrpt::Clock::duration(objects::mrptTicks(1000.25)));
  scan.sensorLabel = "HOKUYO";
  scan.aperture = 2.0F;
  scan.maxRange = 5.0F;
  scan.stdError = 0.03F;
  scan.rightToLeft = false;
  scan.sensorPose = mrpt::poses::CPose3D(0.1, 0.2, 0.3, 0.5, 0, 0);
  const std::vector<float> ranges = {1.2345678F, 5.0F, 3.0F, 0.1F};
  scan.resizeScan(ranges.size());
  for (size_t i = 0; i < ranges.size(); ++i) {
    scan.setScanRange(i, ranges[i]);
    scan.setScanRangeValidity(i, i == 0 || i == 3);  // a no-return and a lost reading between
  }
  {
    const auto log = createLog(folder / "a.clf", LogFormat::kCarmen);
    log->write(scan);
    log->close();
  }
  LogReader reader(folder / "a.clf");
  const auto entry = reader.next();
  ASSERT_TRUE(entry);
  EXPECT_EQ(reader.sensorLabel(), "ROBOTLASER1");
  EXPECT_EQ(entry->scan.time_s, 1000.25);
  EXPECT_NEAR(entry->scan.max_range_m, 5, 1e-9);
  EXPECT_NEAR(entry->scan.step_rad, 2.0 / 3, 1e-8);
  EXPECT_NEAR(entry->scan.T_robot_lidar.x, 0.1, 1e-9);
  EXPECT_NEAR(entry->scan.T_robot_lidar.phi, 0.5, 1e-6);
  EXPECT_EQ(entry->scan.ranges_m[3], 1.2345678F) << "a sweep from left to right is turned round";
  EXPECT_EQ(entry->scan.ranges_m[2], lidar::kNoReturn);
  EXPECT_TRUE(std::isnan(entry->scan.ranges_m[1]));
  EXPECT_EQ(entry->scan.ranges_m[0], 0.1F);
}

TEST(CarmenWriter, CountsWhatItCannotHold) {
  const testing::TempFolder folder;
  const auto log = createLog(folder / "a.clf", LogFormat::kCarmen);
  log->write(CObservation2DRangeScan());
  CObservationOdometry odometry;
  odometry.timestamp = mrpt::Clock::time_point();
  log->write(odometry);
  log->write(CObservationRobotPose());
  EXPECT_EQ(log->dropped(),
            "1 odometry readings without a stamp, 1 robot poses, 1 scans of fewer than 2 readings");
}

}  // namespace
}  // namespace slam::logs
