#include "libslam/logs/read_ahead.h"

#include <gtest/gtest.h>

#include "libslam/core/error.h"
#include "libslam/testing/temp_folder.h"
#include "tests/logs/log_fixtures.h"

namespace slam::logs {
namespace {

struct ReadAheadLog : ::testing::Test {
  testing::TempFolder folder;
  std::string log = folder / "a.rawlog";
  void write(int scans) { writeLog(sampleEntries(scans), log, rawlogs::RawlogForm::kActionFrame); }
};

TEST_F(ReadAheadLog, GivesWhatTheReaderGives) {
  write(150);
  for (const bool is_ahead : {false, true}) {
    LogReader reader(log);
    ReadAhead ahead(log, "", is_ahead);
    EXPECT_EQ(ahead.fractionRead(), 0);
    EXPECT_TRUE(ahead.lidars().empty()) << "nothing was asked for";
    for (int i = 0; i < 150; ++i) {
      const auto expected = reader.next(), given = ahead.next();
      ASSERT_TRUE(expected && given) << i;
      EXPECT_EQ(given->scan.time_s, expected->scan.time_s);
      ASSERT_EQ(given->scan.ranges_m.size(), expected->scan.ranges_m.size());
      EXPECT_EQ(given->scan.ranges_m.back(), expected->scan.ranges_m.back());
      EXPECT_EQ(given->T_odom_robot.x, expected->T_odom_robot.x);
      EXPECT_EQ(ahead.fractionRead(), reader.fractionRead()) << i;
      EXPECT_EQ(ahead.lidars(), reader.lidars());
    }
    EXPECT_FALSE(ahead.next());
    EXPECT_FALSE(ahead.next()) << "the end stays the end";
    EXPECT_EQ(ahead.fractionRead(), 1);
  }
}

TEST_F(ReadAheadLog, ErrorsComeAfterWhatIsWhole) {
  write(40);
  const std::string bytes = unpacked(log);
  writeBytes(bytes.substr(0, bytes.size() - 100), log);
  for (const bool is_ahead : {false, true}) {
    ReadAhead ahead(log, "", is_ahead);
    int scans = 0;
    try {
      while (ahead.next()) ++scans;
      FAIL() << "the log is cut";
    } catch (const core::InputError& error) {
      EXPECT_NE(std::string(error.what()).find("truncated"), std::string::npos) << error.what();
    }
    EXPECT_EQ(scans, 39);
  }
  EXPECT_THROW(ReadAhead(folder / "none.rawlog", "", true), core::InputError);
}

TEST_F(ReadAheadLog, IsGivenUpWithTheRestUnread) {
  write(150);
  ReadAhead ahead(log, "", true);
  EXPECT_TRUE(ahead.next());
}

}  // namespace
}  // namespace slam::logs
