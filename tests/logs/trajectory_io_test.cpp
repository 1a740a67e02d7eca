#include "libslam/logs/trajectory_io.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <clocale>
#include <cmath>
#include <filesystem>
#include <limits>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/files/files.h"
#include "libslam/testing/temp_folder.h"

namespace slam::logs {
namespace {

using core::kPi;

core::Trajectory sample(int count) {
  core::RandomStream random(3, "trajectory");
  core::Trajectory trajectory;
  for (int i = 0; i < count; ++i)
    trajectory.push_back(
        {1.7e9 + 0.2 * i, {random.uniform(-500, 500), random.uniform(-500, 500), random.uniform(-kPi, kPi)}});
  return trajectory;
}

template <class Read>
std::string errorOf(Read read, const std::string& content) {
  const testing::TempFolder folder;
  const std::string path = folder / "t";
  files::writeFileAtomically(path, content);
  try {
    read(path);
  } catch (const core::InputError& error) {
    std::string text = error.what();
    return text.compare(0, path.size(), path) == 0 ? text.substr(path.size()) : text;
  }
  return "no error";
}

std::string written(void (*write)(const core::Trajectory&, const std::string&),
                    const core::Trajectory& trajectory) {
  const testing::TempFolder folder;
  write(trajectory, folder / "t");
  return files::readTextFile(folder / "t");
}

TEST(Tum, WritesFixedDecimals) {
  EXPECT_EQ(
      written(writeTum, {{1.5, {1, -2, kPi / 2}}, {2, {-1e-12, 0.25, -kPi / 3}}}),
      "# time x y z qx qy qz qw\n"
      "1.500000 1.000000000 -2.000000000 0.000000000 0.000000000 0.000000000 0.707106781 0.707106781\n"
      "2.000000 0.000000000 0.250000000 0.000000000 0.000000000 0.000000000 -0.500000000 0.866025404\n");
}

TEST(Tum, GivesBackWhatWasWritten) {
  const testing::TempFolder folder;
  const auto trajectory = sample(200);
  writeTum(trajectory, folder / "t.tum");
  const auto read = readTum(folder / "t.tum");
  ASSERT_EQ(read.size(), trajectory.size());
  for (size_t i = 0; i < read.size(); ++i) {
    // Half of the last decimal; a stamp also half of a double's step at 1.7e9 s (1.2e-7); an angle twice the
    // error of the half angle, whose sine and cosine are both rounded.
    EXPECT_NEAR(read[i].time_s, trajectory[i].time_s, 0.5e-6 + 1.2e-7);
    EXPECT_NEAR(read[i].pose.x, trajectory[i].pose.x, 0.5e-9 + 1e-13);
    EXPECT_NEAR(read[i].pose.y, trajectory[i].pose.y, 0.5e-9 + 1e-13);
    EXPECT_NEAR(core::angleDifference(read[i].pose.phi, trajectory[i].pose.phi), 0, 2 * 0.71e-9);
  }
}

TEST(Tum, ReadsWhatOthersWrite) {
  const testing::TempFolder folder;
  files::writeFileAtomically(folder / "t",
                             "# comment\r\n\r\n"
                             "  1e3\t+1 .5 9 0 0 -2 0 \r\n"            // z dropped, quaternion of any length
                             "1000 1 2 3 0 0.70710678 0 0.70710678");  // pitch of 90 deg: its yaw is lost
  const auto read = readTum(folder / "t");
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].time_s, 1000);
  EXPECT_EQ(read[0].pose.x, 1);
  EXPECT_EQ(read[0].pose.y, 0.5);
  EXPECT_DOUBLE_EQ(std::abs(read[0].pose.phi), kPi);
  EXPECT_EQ(read[1].time_s, 1000) << "equal stamps do not run back";
}

TEST(Tum, DropsRollAndPitchFromTheHeading) {
  const testing::TempFolder folder;
  // Rotation by yaw 0.7, then pitch 0.2, then roll -0.3 (z, y', x''): quaternion product by hand.
  const double yaw = 0.7, pitch = 0.2, roll = -0.3;
  const double cy = std::cos(yaw / 2), sy = std::sin(yaw / 2), cp = std::cos(pitch / 2),
               sp = std::sin(pitch / 2), cr = std::cos(roll / 2), sr = std::sin(roll / 2);
  char line[200];
  std::snprintf(line, sizeof(line), "1 0 0 0 %.12f %.12f %.12f %.12f\n", cy * cp * sr - sy * sp * cr,
                cy * sp * cr + sy * cp * sr, sy * cp * cr - cy * sp * sr, cy * cp * cr + sy * sp * sr);
  files::writeFileAtomically(folder / "t", line);
  EXPECT_NEAR(readTum(folder / "t")[0].pose.phi, yaw, 1e-11) << "12 decimals";
}

TEST(Tum, SaysWhatIsWrongInWhichLine) {
  const std::string good = "# c\n1 0 0 0 0 0 0 1\n";
  EXPECT_EQ(errorOf(readTum, ""), ": holds no pose, expected at least 1");
  EXPECT_EQ(errorOf(readTum, "# only\n\n"), ": holds no pose, expected at least 1");
  EXPECT_EQ(errorOf(readTum, good + "2 0 0 0 0 0 0\n"),
            ":3: found 7 numbers, expected 8 (time x y z qx qy qz qw)");
  EXPECT_EQ(errorOf(readTum, good + "2 0 0 0 0 0 0 1 5\n"),
            ":3: found 9 numbers, expected 8 (time x y z qx qy qz qw)");
  EXPECT_EQ(errorOf(readTum, good + "2 nan 0 0 0 0 0 1\n"), ":3: found 'nan', expected a finite number");
  EXPECT_EQ(errorOf(readTum, good + "2 inf 0 0 0 0 0 1\n"), ":3: found 'inf', expected a finite number");
  EXPECT_EQ(errorOf(readTum, good + "2 1e999 0 0 0 0 0 1\n"), ":3: found '1e999', expected a finite number");
  EXPECT_EQ(errorOf(readTum, good + "2 0,5 0 0 0 0 0 1\n"), ":3: found '0,5', expected a finite number");
  EXPECT_EQ(errorOf(readTum, good + "2 +-1 0 0 0 0 0 1\n"), ":3: found '+-1', expected a finite number");
  EXPECT_EQ(errorOf(readTum, good + "2 0 0 0 0 0 0 0\n"),
            ":3: found a quaternion of length 0, expected length 1");
  EXPECT_EQ(errorOf(readTum, good + "0.5 0 0 0 0 0 0 1\n"),
            ":3: found time 0.500000, expected none before 1.000000");
  EXPECT_EQ(errorOf([](const std::string& path) { readTum(path + "x"); }, good), "x: no such file");
}

TEST(MrptGroundTruth, IsRelativeToTheStartPose) {
  // From (10, 20) looking up: 2 ahead is 2 up, and it turned by a quarter to the right.
  EXPECT_EQ(written(writeMrptGroundTruth, {{1, {10, 20, kPi / 2}}, {2.25, {10, 22, 0}}}),
            "1.000000 0.000000 0.000000 0.000000\n"
            "2.250000 2.000000 0.000000 -1.570796\n");
}

TEST(MrptGroundTruth, GivesBackWhatWasWritten) {
  const testing::TempFolder folder;
  auto trajectory = sample(100);
  const auto start = trajectory.front().pose;
  writeMrptGroundTruth(trajectory, folder / "a.rawlog.GT.txt");
  const auto read = readMrptGroundTruth(folder / "a.rawlog.GT.txt");
  ASSERT_EQ(read.size(), trajectory.size());
  for (size_t i = 0; i < read.size(); ++i) {
    const auto expected = core::between(start, trajectory[i].pose);
    // Half of the sixth decimal, and the rounding of a stamp.
    EXPECT_NEAR(read[i].time_s, trajectory[i].time_s, 0.5e-6 + 1.2e-7);
    EXPECT_NEAR(read[i].pose.x, expected.x, 0.5e-6 + 1e-12);
    EXPECT_NEAR(read[i].pose.y, expected.y, 0.5e-6 + 1e-12);
    EXPECT_NEAR(core::angleDifference(read[i].pose.phi, expected.phi), 0, 0.5e-6 + 1e-12);
  }
}

TEST(MrptGroundTruth, SaysWhatIsWrongInWhichLine) {
  EXPECT_EQ(errorOf(readMrptGroundTruth, "% c\n1 2 3\n"), ":2: found 3 numbers, expected 4 (time x y phi)");
  EXPECT_EQ(errorOf(readMrptGroundTruth, "1 2 3 4\n0 2 3 4\n"),
            ":2: found time 0.000000, expected none before 1.000000");
}

TEST(MrptGroundTruth, ReadsTheTruthThatMrptShips) {
  const std::string path =
      "/usr/share/mrpt/datasets/graphslam-engine-demos/action_observations_map/simul.rawlog.GT.txt";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "mrpt-common's datasets are not installed";
  const auto truth = readTrajectory(path);
  EXPECT_EQ(truth.size(), 1734U);
  EXPECT_EQ(truth.front().time_s, 1464600320.989009);
}

TEST(Csv, GivesBackWhatWasWritten) {
  const testing::TempFolder folder;
  const auto trajectory = sample(100);
  writeTrajectory(trajectory, folder / "a.csv", TrajectoryWriter::Format::kCsv);
  const auto read = readTrajectory(folder / "a.csv");
  ASSERT_EQ(read.size(), trajectory.size());
  for (size_t i = 0; i < read.size(); ++i) {
    // Half of the last decimal, and the rounding of a stamp.
    EXPECT_NEAR(read[i].time_s, trajectory[i].time_s, 0.5e-6 + 1.2e-7);
    EXPECT_NEAR(read[i].pose.x, trajectory[i].pose.x, 0.5e-9 + 1e-13);
    EXPECT_NEAR(core::angleDifference(read[i].pose.phi, trajectory[i].pose.phi), 0, 0.5e-9 + 1e-15);
  }
}

TEST(Csv, ReadsFilesWithoutTheLineOfNamesAndWithBlanks) {
  const testing::TempFolder folder;
  files::writeFileAtomically(folder / "t", "# remark\r\n1, 2 ,+3,-0.5\r\n");
  const auto read = readTrajectory(folder / "t");
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].pose.y, 3);
  EXPECT_EQ(read[0].pose.phi, -0.5);
}

TEST(Csv, SaysWhatIsWrongInWhichLine) {
  const std::string names = "time_s,x_m,y_m,yaw_rad\n";
  EXPECT_EQ(errorOf(readTrajectory, names), ": holds no pose, expected at least 1");
  EXPECT_EQ(errorOf(readTrajectory, names + names), ":2: found 'time_s', expected a finite number");
  EXPECT_EQ(errorOf(readTrajectory, "stamp,tx,ty,theta\n1,2,3,4\n"),
            ":1: found the columns 'stamp,tx,ty,theta', expected time_s,x_m,y_m,yaw_rad");
  EXPECT_EQ(errorOf(readTrajectory, names + "1,2,,4\n"), ":2: found '', expected a finite number");
  EXPECT_EQ(errorOf(readTrajectory, names + "1,2,3\n"),
            ":2: found 3 numbers, expected 4 (time_s,x_m,y_m,yaw_rad)");
  EXPECT_EQ(errorOf(readTrajectory, names + "1,2,3,4\n1 2 3 4\n"),
            ":3: found '1 2 3 4', expected a finite number");
}

TEST(Trajectory, TellsTheFormatsApartByTheirNumbers) {
  const testing::TempFolder folder;
  const core::Trajectory trajectory{{1, {0, 0, 0}}, {2, {1, 0, 0.5}}};
  writeTum(trajectory, folder / "a");
  writeMrptGroundTruth(trajectory, folder / "b");
  for (const auto& path : {folder / "a", folder / "b"}) {
    const auto read = readTrajectory(path);
    ASSERT_EQ(read.size(), 2U);
    EXPECT_NEAR(read[1].pose.phi, 0.5, 0.5e-6);
  }
  EXPECT_EQ(errorOf(readTrajectory, "1 2 3 4 5\n"),
            ":1: found 5 numbers, expected 8 (time x y z qx qy qz qw) or 4 (time x y phi)");
  EXPECT_EQ(errorOf(readTrajectory, "1 0 0 0\n2 0 0 0 0 0 0 1\n"),
            ":2: found 8 numbers, expected 4 (time x y phi)");
}

TEST(Trajectory, WritesTheSameUnderALocaleWithCommas) {
  const core::Trajectory trajectory = sample(3);
  const auto plain = written(writeTum, trajectory);
  const char* found = nullptr;
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "es_ES.UTF-8"})
    if (!found) found = std::setlocale(LC_ALL, name);
  if (!found) GTEST_SKIP() << "no locale with a decimal comma is installed";
  const auto with_commas = written(writeTum, trajectory);
  EXPECT_EQ(errorOf(readTum, with_commas), "no error");
  std::setlocale(LC_ALL, "C");
  EXPECT_EQ(with_commas, plain);
}

TEST(Trajectory, RefusesToWriteWhatNobodyCouldRead) {
  const testing::TempFolder folder;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(writeTum({}, folder / "t"), core::ContractError);
  EXPECT_THROW(writeTum({{1, {nan, 0, 0}}}, folder / "t"), core::ContractError);
  EXPECT_THROW(writeMrptGroundTruth({{2, {}}, {1, {}}}, folder / "t"), core::ContractError);
  EXPECT_THROW(writeTum({{1, {}}}, folder / "none/t"), core::IoError);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace slam::logs
