#include "libslam/logs/log_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>

#include "libslam/testing/temp_folder.h"
#include "tests/logs/log_fixtures.h"

namespace slam::logs {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

size_t filesIn(const std::string& folder) {
  return static_cast<size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator{}));
}

class BothForms : public ::testing::TestWithParam<rawlogs::RawlogForm> {};
INSTANTIATE_TEST_SUITE_P(LogWriter, BothForms,
                         ::testing::Values(rawlogs::RawlogForm::kActionFrame,
                                           rawlogs::RawlogForm::kObservationOnly),
                         [](const auto& form) {
                           return form.param == rawlogs::RawlogForm::kActionFrame ? "ActionFrame"
                                                                                  : "ObservationOnly";
                         });

void expectSamePose(const core::Pose2& read, const core::Pose2& written) {
  // A few rounding errors: composing again, and MRPT's own wrapping of the angle.
  EXPECT_NEAR(read.x, written.x, 1e-13);
  EXPECT_NEAR(read.y, written.y, 1e-13);
  EXPECT_NEAR(core::angleDifference(read.phi, written.phi), 0, 1e-13);
}

void expectSameScan(const lidar::Scan& read, const lidar::Scan& written) {
  EXPECT_EQ(read.time_s, written.time_s);
  EXPECT_EQ(read.max_range_m, written.max_range_m);
  EXPECT_EQ(read.range_sigma_m, written.range_sigma_m);
  // MRPT keeps the field of view as a float: 6e-8 of pi.
  EXPECT_NEAR(read.step_rad, written.step_rad, 2e-7 / 4);
  EXPECT_NEAR(read.first_angle_rad, written.first_angle_rad, 1e-7);
  expectSamePose(read.T_robot_lidar, written.T_robot_lidar);
  ASSERT_EQ(read.ranges_m.size(), written.ranges_m.size());
  for (size_t i = 0; i < read.ranges_m.size(); ++i) {
    if (std::isnan(written.ranges_m[i]))
      EXPECT_TRUE(std::isnan(read.ranges_m[i])) << "beam " << i;
    else
      EXPECT_EQ(read.ranges_m[i], written.ranges_m[i]) << "beam " << i;
  }
}

TEST_P(BothForms, GivesBackWhatWasWritten) {
  const testing::TempFolder folder;
  const auto written = sampleEntries(7);
  writeLog(written, folder / "a.rawlog", GetParam());
  const auto read = readLog(folder / "a.rawlog");
  ASSERT_EQ(read.size(), written.size());
  for (size_t i = 0; i < read.size(); ++i) {
    SCOPED_TRACE("entry " + std::to_string(i));
    EXPECT_TRUE(read[i].has_odometry);
    expectSamePose(read[i].T_odom_robot, written[i].T_odom_robot);
    expectSamePose(read[i].T_previous_robot, written[i].T_previous_robot);
    expectSameScan(read[i].scan, written[i].scan);
  }
}

TEST_P(BothForms, GivesBackWhereOdometryIsMissing) {
  const testing::TempFolder folder;
  auto written = sampleEntries(5);
  for (const size_t i : {2, 3}) {
    written[i].has_odometry = false;
    written[i].T_previous_robot = {};
    written[i].T_odom_robot = written[1].T_odom_robot;
  }
  written[4].T_odom_robot = written[3].T_odom_robot * written[4].T_previous_robot;
  writeLog(written, folder / "a.rawlog", GetParam());
  const auto read = readLog(folder / "a.rawlog");
  ASSERT_EQ(read.size(), written.size());
  for (size_t i = 0; i < read.size(); ++i) {
    SCOPED_TRACE("entry " + std::to_string(i));
    EXPECT_EQ(read[i].has_odometry, written[i].has_odometry);
    expectSamePose(read[i].T_odom_robot, written[i].T_odom_robot);
    expectSamePose(read[i].T_previous_robot, written[i].T_previous_robot);
  }
}

TEST_P(BothForms, WritesTheSameBytesForTheSameEntries) {
  const testing::TempFolder folder;
  writeLog(sampleEntries(20), folder / "a.rawlog", GetParam());
  writeLog(sampleEntries(20), folder / "another name.rawlog", GetParam());
  const std::string bytes = readBytes(folder / "a.rawlog");
  EXPECT_EQ(bytes, readBytes(folder / "another name.rawlog"));
  // RFC 1952, 2.3: bytes 4 to 7 are the time of writing, bit 3 of byte 3 says that a name follows.
  ASSERT_GT(bytes.size(), 18U);
  EXPECT_EQ(bytes.substr(3, 5), std::string(5, '\0'));
  auto other = sampleEntries(20);
  other[10].scan.ranges_m[0] += 0.001F;
  writeLog(other, folder / "b.rawlog", GetParam());
  EXPECT_NE(bytes, readBytes(folder / "b.rawlog"));
}

TEST_P(BothForms, IsReadByMrptsOwnRawlogEdit) {
  if (!testing::programExists("rawlog-edit")) GTEST_SKIP() << "rawlog-edit (mrpt-apps) is not installed";
  const testing::TempFolder folder;
  writeLog(sampleEntries(11), folder / "a.rawlog", GetParam());
  const auto info = testing::runCommand("cd '" + folder.path() + "' && rawlog-edit --info -i a.rawlog");
  EXPECT_EQ(info.exit_code, 0) << info.err;
  const bool frames = GetParam() == rawlogs::RawlogForm::kActionFrame;
  EXPECT_THAT(info.out, HasSubstr(frames ? "Actions/SensoryFrame format       : Yes"
                                         : "Actions/SensoryFrame format       : No"));
  EXPECT_THAT(info.out, HasSubstr(frames ? "Observations format               : No"
                                         : "Observations format               : Yes"));
  EXPECT_THAT(info.out, HasSubstr("Earliest timestamp                : 1700000000.000000"));
  EXPECT_THAT(info.out, HasSubstr("Latest timestamp                  : 1700000002.000000"));
  EXPECT_THAT(info.out, HasSubstr(frames ? "All sensor labels                 : LASER\n"
                                         : "All sensor labels                 : LASER, ODOMETRY\n"));
}

TEST(LogWriter, LeavesNothingWithoutClose) {
  const testing::TempFolder folder;
  {
    LogWriter writer(folder / "a.rawlog", rawlogs::RawlogForm::kActionFrame);
    writer.write(sampleEntries(1)[0]);
    EXPECT_FALSE(fs::exists(folder / "a.rawlog"));
  }
  EXPECT_EQ(filesIn(folder.path()), 0U);
}

TEST(LogWriter, KeepsTheOldFileUntilClose) {
  const testing::TempFolder folder;
  writeBytes("old", folder / "a.rawlog");
  LogWriter writer(folder / "a.rawlog", rawlogs::RawlogForm::kObservationOnly);
  writer.write(sampleEntries(1)[0]);
  EXPECT_EQ(readBytes(folder / "a.rawlog"), "old");
  writer.close();
  EXPECT_EQ(readLog(folder / "a.rawlog").size(), 1U);
  EXPECT_EQ(filesIn(folder.path()), 1U);
}

TEST(LogWriter, WritesAnEmptyLogThatReadsAsEmpty) {
  const testing::TempFolder folder;
  writeLog({}, folder / "a.rawlog", rawlogs::RawlogForm::kActionFrame);
  EXPECT_TRUE(readLog(folder / "a.rawlog").empty());
}

std::string writeError(const std::string& path, int entries) {
  try {
    writeLog(sampleEntries(entries), path, rawlogs::RawlogForm::kActionFrame);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "no error";
}

TEST(LogWriter, ReportsAPathThatCannotBeWritten) {
  const testing::TempFolder folder;
  EXPECT_EQ(writeError(folder / "none/a.rawlog", 1),
            folder / "none/a.rawlog" + ": cannot be written: No such file or directory");
  EXPECT_EQ(writeError(folder.path(), 1), folder.path() + ": is a folder, expected a file");
}

/// No file may grow beyond a few bytes, which is as good as a full disk.
class FullDisk : public ::testing::Test {
 protected:
  void SetUp() override {
    before_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &limit_);
    const rlimit small{16, limit_.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  }
  void TearDown() override {
    setrlimit(RLIMIT_FSIZE, &limit_);
    std::signal(SIGXFSZ, before_);
  }
  const testing::TempFolder folder_{};

 private:
  rlimit limit_{};
  void (*before_)(int) = SIG_DFL;
};

TEST_F(FullDisk, IsReportedByCloseForALogThatFitsIntoMemory) {
  EXPECT_EQ(writeError(folder_ / "a.rawlog", 1),
            folder_ / "a.rawlog" + ": cannot be written: File too large");
  EXPECT_EQ(filesIn(folder_.path()), 0U);
}

TEST_F(FullDisk, StopsALongLogWhileItIsWritten) {
  const auto entry = sampleEntries(1)[0];
  auto writer = std::make_unique<LogWriter>(folder_ / "a.rawlog", rawlogs::RawlogForm::kObservationOnly);
  std::string error;
  for (int i = 0; i < 100'000 && error.empty(); ++i) {
    try {
      writer->write(entry);
    } catch (const core::IoError& io_error) {
      error = io_error.what();
    }
  }
  EXPECT_EQ(error, folder_ / "a.rawlog" + ": cannot be written: File too large");
  writer.reset();
  EXPECT_EQ(filesIn(folder_.path()), 0U);
}

TEST(LogWriter, RefusesBrokenEntriesAndUseAfterClose) {
  const testing::TempFolder folder;
  LogWriter writer(folder / "a.rawlog", rawlogs::RawlogForm::kActionFrame);
  auto entry = sampleEntries(1)[0];
  entry.T_odom_robot.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(writer.write(entry), core::ContractError);
  entry = sampleEntries(1)[0];
  entry.scan.ranges_m.resize(1);
  EXPECT_THROW(writer.write(entry), core::ContractError);
  writer.close();
  EXPECT_THROW(writer.write(sampleEntries(1)[0]), core::ContractError);
  EXPECT_THROW(writer.close(), core::ContractError);
}

}  // namespace
}  // namespace slam::logs
