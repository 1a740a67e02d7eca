// Logs that are cut, damaged or none at all.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/obs/CObservationBatteryState.h>
#include <sys/wait.h>

#include <limits>

#include "libslam/files/memory_guard.h"
#include "libslam/logs/log_reader.h"
#include "libslam/testing/temp_folder.h"
#include "tests/logs/log_fixtures.h"

namespace slam::logs {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

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
  writeLog(sampleEntries(40), folder / "a.rawlog", rawlogs::RawlogForm::kActionFrame);
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
  writeLog(sampleEntries(4), folder / "a.rawlog", rawlogs::RawlogForm::kObservationOnly);
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
    writeLog(sampleEntries(count), folder / "a.rawlog", rawlogs::RawlogForm::kObservationOnly);
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
  writeLog(sampleEntries(4), folder / "a.rawlog", rawlogs::RawlogForm::kActionFrame);
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
  for (const auto form : {rawlogs::RawlogForm::kActionFrame, rawlogs::RawlogForm::kObservationOnly}) {
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
  writeLog(sampleEntries(300), folder / "b.rawlog", rawlogs::RawlogForm::kActionFrame);
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
  writeLog(sampleEntries(6), folder / "a.rawlog", rawlogs::RawlogForm::kActionFrame);
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
  if (!files::MemoryGuard::isKept()) GTEST_SKIP() << "this build has an allocator of its own";
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    log << rawScan(kStart_s, "L") << commentSaying("four");
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
  writeLog(sampleEntries(2), folder / "a.rawlog", rawlogs::RawlogForm::kActionFrame);
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

// MRPT writes a number of voltages that a file claims to where it has no room for them, and crashes: a copy
// of this process reads such classes first, and crashes in its place.
TEST(LogReader, RefusesAnEntryThatMrptCrashesAtAsCorrupt) {
  if (!files::MemoryGuard::isKept()) GTEST_SKIP() << "this build has memory for it";
  const testing::TempFolder folder;
  mrpt::obs::CObservationBatteryState battery;
  battery.timestamp = mrptTime(kStart_s);
  battery.voltageOtherBatteries.setConstant(7, 3.0);
  {
    RawObjects log(folder / "a.rawlog");
    log << battery << rawScan(kStart_s, "L") << battery << rawScan(kStart_s + 1, "L");
  }
  auto plain = unpacked(folder / "a.rawlog");
  writeBytes(plain, folder / "good.rawlog");
  EXPECT_EQ(readOutcome(folder / "good.rawlog").error, "");
  EXPECT_EQ(readOutcome(folder / "good.rawlog").entries, 2U);
  const std::string size("\7\0\0\0", 4);
  plain.replace(plain.rfind(size), size.size(), "\xFF\xFF\xFF\x7F", 4);
  writeBytes(plain, folder / "damaged.rawlog");
  const auto outcome = readOutcome(folder / "damaged.rawlog");
  EXPECT_EQ(outcome.entries, 1U);
  EXPECT_THAT(outcome.error, HasSubstr("(an entry that cannot be read), after 2 good entries"));
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "no copy is left";
}

// Where MRPT expects a distribution it takes nothing else, and copies what it has not got.
TEST(LogReader, RefusesAMotionWithAPoseWhereItsDistributionBelongs) {
  const testing::TempFolder folder;
  writeLog(sampleEntries(3), folder / "a.rawlog", rawlogs::RawlogForm::kActionFrame);
  const auto plain = unpacked(folder / "a.rawlog");
  const std::string action = "mrpt::obs::CActionRobotMovement2D";
  const auto errorWith = [&](char version, const std::string& method) {
    auto damaged = plain;
    const size_t at = damaged.rfind(action) + action.size();
    damaged[at] = version;
    damaged.replace(at + 1, 4, method);
    writeBytes(damaged, folder / "damaged.rawlog");
    const auto outcome = readOutcome(folder / "damaged.rawlog");
    EXPECT_EQ(outcome.entries, 2U);
    return outcome.error;
  };
  const std::string scan_matching("\1\0\0\0", 4);
  for (const char version : {'\2', '\3', '\4', '\7'})
    EXPECT_THAT(errorWith(version, scan_matching), HasSubstr("(an entry that cannot be read), after 4 good"));
  // The first two versions have the distribution before the method.
  EXPECT_THAT(errorWith('\0', ""), HasSubstr("(an entry that cannot be read), after 4 good"));
}

TEST(LogReader, RefusesEntriesNestedWithoutEnd) {
  const testing::TempFolder folder;
  writeLog(sampleEntries(1), folder / "a.rawlog", rawlogs::RawlogForm::kActionFrame);
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
