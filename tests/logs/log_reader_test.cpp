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
using ::testing::HasSubstr;
using ::testing::StartsWith;

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

mrpt::obs::CObservationComment comment(const std::string& text) {
  mrpt::obs::CObservationComment observation;
  observation.text = text;
  return observation;
}

// --- What is in the log ---------------------------------------------------------------------------------

TEST(LogReader, ReadsAPlainLogAsThePackedOne) {
  const testing::TempFolder folder;
  writeLog(sampleEntries(9), folder / "packed.rawlog", RawlogForm::kActionFrame);
  writeBytes(unpacked(folder / "packed.rawlog"), folder / "plain.rawlog");
  const auto plain = readLog(folder / "plain.rawlog"), packed = readLog(folder / "packed.rawlog");
  ASSERT_EQ(plain.size(), 9U);
  EXPECT_EQ(travelled(plain), travelled(packed));
}

TEST(LogReader, ReadsSeveralGzipMembersInARow) {
  const testing::TempFolder folder;
  writeLog(sampleEntries(3), folder / "a.rawlog", RawlogForm::kActionFrame);
  const auto bytes = readBytes(folder / "a.rawlog");
  writeBytes(bytes + bytes, folder / "twice.rawlog");
  EXPECT_EQ(readLog(folder / "twice.rawlog").size(), 6U);
}

TEST(LogReader, SkipsAndCountsWhatIsNeitherScanNorOdometry) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "frames.rawlog");
    log << comment("hello") << collection(wheelAction(kStart_s, 0))
        << frame(mrpt::obs::CObservationImage(), rawScan(kStart_s, "L"), mrpt::obs::CObservationIMU())
        << comment("between") << collection(wheelAction(kStart_s, 1)) << frame(mrpt::obs::CObservationIMU())
        << collection(wheelAction(kStart_s, 2)) << frame(rawScan(kStart_s + 1, "L"));
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
        << rawScan(kStart_s, "L") << comment("end");
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

// --- Bad input ------------------------------------------------------------------------------------------

TEST(LogReader, SaysWhatAFileIsThatIsNoLog) {
  const testing::TempFolder folder;
  const auto errorOf = [&folder](const std::string& bytes) {
    writeBytes(bytes, folder / "x");
    return readOutcome(folder / "x").error;
  };
  const std::string path = folder / "x";
  EXPECT_EQ(readOutcome(folder / "none").error, folder / "none" + ": no such file");
  EXPECT_EQ(readOutcome(folder.path()).error, folder.path() + ": is a folder, expected a file");
  const std::string formats =
      ", expected an MRPT rawlog, a CARMEN log, a ROS 1 bag, a ROS 2 bag (.db3) or MCAP";
  EXPECT_EQ(errorOf(""), path + ": is empty" + formats);
  const std::string other = path + ": is no log: it starts with other data" + formats;
  EXPECT_EQ(errorOf("1 2 3 4\n"), other);
  EXPECT_EQ(errorOf("\x89PNG\r\n\x1A\n and so on"), other);
  EXPECT_EQ(errorOf("\x1F"), path + ": is not an MRPT rawlog: it starts with other data");
  EXPECT_EQ(errorOf(std::string(1000, '\0')), other);
  EXPECT_EQ(errorOf(std::string("\x83"
                                "Foo",
                                4) +
                    std::string(200, 'x')),
            path + ": is not an MRPT rawlog: it starts with an object of class 'Foo'");
  {
    RawObjects log(path);
    log << mrpt::maps::CSimpleMap();
  }
  EXPECT_EQ(readOutcome(path).error,
            path + ": is not an MRPT rawlog: it starts with an object of class 'mrpt::maps::CSimpleMap'");
}

TEST(LogReader, ReportsTheByteOffsetOfATruncatedLog) {
  const testing::TempFolder folder;
  writeLog(sampleEntries(40), folder / "a.rawlog", RawlogForm::kActionFrame);
  const auto bytes = readBytes(folder / "a.rawlog");
  const auto size = std::to_string(bytes.size() - 1);
  writeBytes(bytes.substr(0, bytes.size() - 1), folder / "cut.rawlog");
  const auto outcome = readOutcome(folder / "cut.rawlog");
  EXPECT_EQ(outcome.entries, 40U) << "only the checksum is cut";
  EXPECT_EQ(outcome.error, folder / "cut.rawlog" + ": truncated: ends at byte " + size + " of " + size +
                               " inside an entry, after 80 good entries");
}

TEST(LogReader, NoticesACutAnywhereInAPackedLog) {
  const testing::TempFolder folder;
  writeLog(sampleEntries(4), folder / "a.rawlog", RawlogForm::kObservationOnly);
  const auto bytes = readBytes(folder / "a.rawlog");
  size_t before = 0;
  for (size_t size = 2; size < bytes.size(); ++size) {
    writeBytes(bytes.substr(0, size), folder / "cut.rawlog");
    const auto outcome = readOutcome(folder / "cut.rawlog");
    ASSERT_THAT(outcome.error, StartsWith(folder / "cut.rawlog" + ": truncated: ends at byte " +
                                          std::to_string(size) + " of " + std::to_string(size)))
        << "cut at " << size;
    ASSERT_GE(outcome.entries, before) << "more bytes gave fewer entries, cut at " << size;
    before = outcome.entries;
  }
  EXPECT_EQ(before, 4U);
}

TEST(LogReader, NoticesACutInAPlainLogUnlessItFallsBetweenTwoEntries) {
  const testing::TempFolder folder;
  std::vector<size_t> borders;  // brute force: the sizes of the shorter logs
  for (int count = 0; count <= 3; ++count) {
    writeLog(sampleEntries(count), folder / "a.rawlog", RawlogForm::kObservationOnly);
    borders.push_back(unpacked(folder / "a.rawlog").size());
  }
  const auto plain = unpacked(folder / "a.rawlog");
  const auto outcomeOf = [&](size_t size) {
    writeBytes(plain.substr(0, size), folder / "cut.rawlog");
    return readOutcome(folder / "cut.rawlog");
  };
  EXPECT_EQ(outcomeOf(borders[1]).error, "");
  EXPECT_EQ(outcomeOf(borders[2]).error, "");
  EXPECT_EQ(outcomeOf(20).error,
            folder / "cut.rawlog" + ": is not an MRPT rawlog: it starts with other data");
  // Every cut inside the second pair; only the end of its odometry is a border between entries as well.
  size_t clean_ends = 0;
  for (size_t size = borders[1] + 1; size < borders[2]; ++size) {
    const auto outcome = outcomeOf(size);
    ASSERT_EQ(outcome.entries, 1U) << "cut at " << size;
    if (outcome.error.empty())
      ++clean_ends;
    else
      ASSERT_THAT(outcome.error, HasSubstr(": truncated: ends at byte " + std::to_string(size) + " of "))
          << size;
  }
  EXPECT_EQ(clean_ends, 1U);
}

// MRPT's parsers crash on some of these: they must not see them.
TEST(LogReader, NoticesEveryFlippedBitThatChangesTheContentBeforeItsFirstEntry) {
  const testing::TempFolder folder;
  writeLog(sampleEntries(4), folder / "a.rawlog", RawlogForm::kActionFrame);
  const auto bytes = readBytes(folder / "a.rawlog"), content = unpacked(folder / "a.rawlog");
  size_t harmless = 0, looks_cut = 0;
  for (size_t i = 2; i < bytes.size(); ++i) {
    for (const int bit : {0, 4, 7}) {
      SCOPED_TRACE("byte " + std::to_string(i) + " bit " + std::to_string(bit));
      std::string flipped = bytes;
      flipped[i] = static_cast<char>(flipped[i] ^ (1 << bit));
      writeBytes(flipped, folder / "flipped.rawlog");
      const auto outcome = readOutcome(folder / "flipped.rawlog");
      if (outcome.error.empty()) {
        // The time of writing, or a distance to another copy of the same bytes.
        ASSERT_EQ(unpacked(folder / "flipped.rawlog"), content);
        ASSERT_EQ(outcome.entries, 4U);
        ++harmless;
      } else if (outcome.error.find(": truncated: ends at byte ") != std::string::npos) {
        // The flip hides the mark that ends the data; what is before a cut is read.
        ++looks_cut;
      } else {
        ASSERT_THAT(outcome.error, HasSubstr(": corrupt: the gzip "));
        ASSERT_EQ(outcome.entries, 0U);
      }
    }
  }
  // Both are rare: 3 bits of the 6 bytes of time, level and system in the header, and few more.
  EXPECT_LT(harmless, 18 + bytes.size() / 20);
  EXPECT_LT(looks_cut, bytes.size() / 20);
}

TEST(LogReader, ReportsAChecksumThatDoesNotMatch) {
  const testing::TempFolder folder;
  for (const auto form : {RawlogForm::kActionFrame, RawlogForm::kObservationOnly}) {
    writeLog(sampleEntries(2000), folder / "a.rawlog", form);
    auto bytes = readBytes(folder / "a.rawlog");
    const auto size = std::to_string(bytes.size());
    bytes[bytes.size() - 8] ^= 1;  // RFC 1952, 2.3.1: the last 8 bytes are checksum and length
    writeBytes(bytes, folder / "a.rawlog");
    EXPECT_EQ(readOutcome(folder / "a.rawlog").error,
              folder / "a.rawlog" + ": corrupt: the gzip checksum at byte " +
                  std::to_string(bytes.size() - 4) + " of " + size +
                  " does not match, so one of its about 4000 entries is wrong");
  }
}

TEST(LogReader, ReportsWhereTheGzipDataBreaks) {
  const testing::TempFolder folder;
  writeLog(sampleEntries(300), folder / "b.rawlog", RawlogForm::kActionFrame);
  // Behind a whole gzip member stands something that is none.
  writeBytes(readBytes(folder / "b.rawlog") + "garbage that is no gzip member", folder / "damaged.rawlog");
  const auto outcome = readOutcome(folder / "damaged.rawlog");
  EXPECT_THAT(outcome.error,
              StartsWith(folder / "damaged.rawlog" + ": corrupt: the gzip data breaks at byte " +
                         std::to_string(readBytes(folder / "b.rawlog").size() + 2)));
  EXPECT_THAT(outcome.error, HasSubstr(" (incorrect header check), after about 599 good entries"));
}

TEST(LogReader, GivesTheEntriesBeforeTheDamageFirst) {
  const testing::TempFolder folder;
  writeLog(sampleEntries(6), folder / "a.rawlog", RawlogForm::kActionFrame);
  auto plain = unpacked(folder / "a.rawlog");
  const std::string name = "mrpt::obs::CSensoryFrame";
  size_t at = 0;
  for (int i = 0; i < 3; ++i) at = plain.find(name, at + 1);
  const auto errorWith = [&](const std::string& new_name) {
    auto damaged = plain;
    damaged.replace(at, new_name.size(), new_name);
    writeBytes(damaged, folder / "damaged.rawlog");
    const auto outcome = readOutcome(folder / "damaged.rawlog");
    EXPECT_EQ(outcome.entries, 2U);
    EXPECT_THAT(outcome.error, StartsWith(folder / "damaged.rawlog" + ": corrupt near byte "));
    return outcome.error;
  };
  EXPECT_THAT(errorWith("mrpt::obs::CSensoryPlane"),
              HasSubstr("(an entry of the unknown class 'mrpt::obs::CSensoryPlane'), after 5 good entries"));
  EXPECT_THAT(errorWith(std::string(5, '\1')), HasSubstr("(no entry starts here), after 5 good entries"));
  // Another class that exists but whose content is not this: its name is as long.
  EXPECT_THAT(errorWith("mrpt::obs::CSensoryFrame\x7F"),
              HasSubstr("(an entry that cannot be read), after 5 good entries"));
}

TEST(LogReader, RefusesAnEntryOfImpossibleSizeAsCorrupt) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the address sanitizer does not live within a limit of memory";
#endif
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    log << rawScan(kStart_s, "L") << comment("four");
  }
  auto plain = unpacked(folder / "a.rawlog");
  plain.replace(plain.find("four") - 4, 4, std::string("\xFF\xFF\xFF\x7F", 4));  // the length of the text
  writeBytes(plain, folder / "damaged.rawlog");
  const auto outcome = readOutcome(folder / "damaged.rawlog");
  EXPECT_EQ(outcome.entries, 1U);
  EXPECT_THAT(outcome.error,
              ::testing::ContainsRegex("damaged.rawlog: corrupt near byte [0-9]* of [0-9]* "
                                       "\\(an entry of impossible size\\), after 1 good entry"));
}

// MRPT writes to where it has got no memory: its allocator does not say so.
TEST(LogReader, RefusesAScanOfImpossibleSizeAsCorrupt) {
  const testing::TempFolder folder;
  writeLog(sampleEntries(2), folder / "a.rawlog", RawlogForm::kActionFrame);
  const auto plain = unpacked(folder / "a.rawlog");
  const size_t scan = plain.find("mrpt::obs::CObservation2DRangeScan");
  int refused = 0;
  for (size_t at = scan + 34; at < scan + 200; ++at) {
    auto damaged = plain;
    damaged.replace(at, 4, std::string("\xFF\xFF\xFF\x3F", 4));
    writeBytes(damaged, folder / "damaged.rawlog");
    refused +=
        readOutcome(folder / "damaged.rawlog").error.find("impossible size") != std::string::npos ? 1 : 0;
  }
  EXPECT_GE(refused, 1);
}

TEST(LogReader, RefusesEntriesNestedWithoutEnd) {
  const testing::TempFolder folder;
  writeLog(sampleEntries(1), folder / "a.rawlog", RawlogForm::kActionFrame);
  const auto plain = unpacked(folder / "a.rawlog");
  const size_t begin = plain.find("mrpt::obs::CSensoryFrame") - 1,
               inner = plain.find("mrpt::obs::CObservation2DRangeScan") - 1;
  std::string nested;
  for (int depth = 0; depth < 300000; ++depth) nested += plain.substr(begin, inner - begin);
  writeBytes(nested, folder / "nested.rawlog");
  EXPECT_THAT(readOutcome(folder / "nested.rawlog").error, HasSubstr("(an entry that cannot be read)"));
}

TEST(LogReader, NamesTheEntryOfAScanThatCannotBeUsed) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    log << rawScan(kStart_s, "L") << rawScan(kStart_s, "L", 1);
  }
  const auto outcome = readOutcome(folder / "a.rawlog");
  EXPECT_EQ(outcome.entries, 1U);
  EXPECT_EQ(outcome.error, folder / "a.rawlog" + ": entry 2: laser scan with 1 beams, expected at least 2");
  {
    RawObjects log(folder / "a.rawlog");
    log << rawScan(kStart_s, "L") << rawOdometry(kStart_s, std::numeric_limits<double>::quiet_NaN());
  }
  EXPECT_EQ(readOutcome(folder / "a.rawlog").error,
            folder / "a.rawlog" + ": entry 2: odometry that is not finite");
}

}  // namespace
}  // namespace slam::logs
