#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "libslam/testing/temp_folder.h"
#include "tests/logs/log_fixtures.h"

namespace slam::logs {
namespace {

using ::testing::HasSubstr;

std::string errorOf(const LogInfo& info) {
  try {
    requireUsable(info);
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(LogInfo, SumsUpALogDrawnByHand) {
  const testing::TempFolder folder;
  const std::string path = folder / "a.rawlog";
  auto entries = sampleEntries(4);
  const double times_s[] = {10, 11, 14, 13.5};
  for (size_t i = 0; i < 4; ++i) {
    entries[i].scan.time_s = kStart_s + times_s[i];
    entries[i].T_previous_robot = i == 0 ? core::Pose2{} : core::Pose2{0.3, 0.4, 1};
    entries[i].T_odom_robot =
        i == 0 ? core::Pose2{} : entries[i - 1].T_odom_robot * entries[i].T_previous_robot;
  }
  writeLog(entries, path, rawlogs::RawlogForm::kActionFrame);
  const LogInfo info = inspectLog(path);
  EXPECT_EQ(info.path, path);
  EXPECT_EQ(info.form, "action / sensory frame");
  EXPECT_EQ(info.file_bytes, std::filesystem::file_size(path));
  EXPECT_EQ(info.entries, 8U);
  EXPECT_EQ(info.scans, 4U);
  EXPECT_EQ(info.odometry_readings, 4U);
  EXPECT_EQ(info.other_observations, 0U);
  EXPECT_EQ(info.first_time_s, kStart_s + 10);
  EXPECT_EQ(info.last_time_s, kStart_s + 14);
  EXPECT_EQ(info.sensor_label, "LASER");
  EXPECT_EQ(info.beams, 5);
  EXPECT_NEAR(info.fov_rad, core::kPi, 2e-7) << "a float in the log";
  EXPECT_NEAR(info.step_rad, core::kPi / 4, 1e-7);
  EXPECT_EQ(info.max_range_m, 30);
  EXPECT_NEAR(info.T_robot_lidar.phi, 0.5, 1e-7);
  EXPECT_FALSE(info.geometry_varies);
  EXPECT_NEAR(info.odometry_length_m, 1.5, 1e-12);
  EXPECT_EQ(info.median_scan_period_s, 1);
  EXPECT_EQ(info.longest_gap_s, 3);
  EXPECT_TRUE(info.stamps_run_back);
  EXPECT_EQ(info.no_return_share, 0.2);
  EXPECT_EQ(info.lost_share, 0.2);
  EXPECT_EQ(errorOf(info), "");

  entries[3].scan.time_s = kStart_s + 15;
  entries[3].scan.max_range_m = 31;
  writeLog(entries, path, rawlogs::RawlogForm::kObservationOnly);
  const LogInfo other = inspectLog(path);
  EXPECT_EQ(other.form, "observation only");
  EXPECT_FALSE(other.stamps_run_back);
  EXPECT_TRUE(other.geometry_varies);
}

TEST(LogInfo, SaysThatALogWithoutScansIsOfNoUse) {
  const testing::TempFolder folder;
  const std::string path = folder / "a.rawlog";
  {
    RawObjects log(path);
    log << rawOdometry(kStart_s, 0);
  }
  const LogInfo info = inspectLog(path);
  EXPECT_EQ(info.scans, 0U);
  EXPECT_EQ(info.first_time_s, 0);
  EXPECT_EQ(info.longest_gap_s, 0);
  EXPECT_EQ(errorOf(info), path + ": holds 0 laser scans, expected at least 1");
  writeLog({}, path, rawlogs::RawlogForm::kActionFrame);
  EXPECT_EQ(inspectLog(path).form, "empty");
  LogInfo one_beam = info;
  one_beam.scans = one_beam.beams = 1;
  EXPECT_EQ(errorOf(one_beam), path + ": holds laser scans of 1 beam, expected at least 2");
}

TEST(LogInfo, DescribesALogOfASingleScan) {
  const testing::TempFolder folder;
  writeLog(sampleEntries(1), folder / "a.rawlog", rawlogs::RawlogForm::kActionFrame);
  const LogInfo info = inspectLog(folder / "a.rawlog");
  EXPECT_EQ(info.scans, 1U);
  EXPECT_EQ(info.first_time_s, info.last_time_s);
  EXPECT_EQ(info.median_scan_period_s, 0);
  EXPECT_FALSE(info.stamps_run_back);
  EXPECT_EQ(errorOf(info), "");
}

const std::string kDatasets = "/usr/share/mrpt/datasets/";
const std::string kMalaga = kDatasets + "2006-01ENE-21-SENA_Telecom Faculty_one_loop_only.rawlog";

TEST(LogInfo, AgreesWithRawlogEditOnTheMalagaLoop) {
  if (!std::filesystem::exists(kMalaga)) GTEST_SKIP() << "mrpt-common's datasets are not installed";
  const LogInfo info = inspectLog(kMalaga);
  EXPECT_EQ(info.form, "action / sensory frame");
  EXPECT_EQ(info.entries, 449U);
  // One frame more than rawlog-edit counts: the log begins with a frame, and MRPT reads pairs only.
  EXPECT_EQ(info.scans, 225U);
  EXPECT_EQ(info.odometry_readings, 224U);
  EXPECT_EQ(info.beams, 361);
  EXPECT_NEAR(info.fov_rad, core::kPi, 1e-6);
  EXPECT_EQ(info.sensor_label, "");
  EXPECT_FALSE(info.stamps_run_back);

  if (!testing::programExists("rawlog-edit")) GTEST_SKIP() << "rawlog-edit (mrpt-apps) is not installed";
  const auto edit = testing::runCommand("rawlog-edit --info -i '" + kMalaga + "'");
  EXPECT_THAT(edit.out, HasSubstr("Overall number of objects         : 449\n"));
  EXPECT_THAT(edit.out,
              ::testing::ContainsRegex("/ +224 / *3[.]792"));  // the blanks differ by MRPT's version
  EXPECT_THAT(edit.out, HasSubstr("Latest timestamp                  : 1137834284.788331"));
  EXPECT_NEAR(info.last_time_s, 1137834284.788331, 0.5e-6) << "rawlog-edit prints 6 decimals";
}

/// MRPT 2.14 no longer reads the rotating scans of its own files: its rawlog-edit finds one object, without a
/// time.
bool mrptReads(const std::filesystem::path& log) {
  const auto seen = testing::runCommand("rawlog-edit --info -i '" + log.string() + "'");
  return seen.out.find("Earliest timestamp                : 0.000000") == std::string::npos;
}

TEST(LogInfo, ReadsEveryLogThatMrptShips) {
  if (!std::filesystem::exists(kDatasets)) GTEST_SKIP() << "mrpt-common's datasets are not installed";
  int logs = 0;
  for (const auto& file : std::filesystem::recursive_directory_iterator(kDatasets)) {
    if (file.path().extension() != ".rawlog") continue;
    SCOPED_TRACE(file.path().string());
    if (file.path().filename().string().rfind("rot_scan_", 0) == 0 && !mrptReads(file.path())) continue;
    EXPECT_GT(inspectLog(file.path().string()).entries, 0U);
    ++logs;
  }
  EXPECT_GT(logs, 0);
}

}  // namespace
}  // namespace slam::logs
