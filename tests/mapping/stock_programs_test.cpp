// MRPT's own programs, with our configurations, plugin and files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/config/CConfigFile.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/maps/CMultiMetricMap.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/serialization/CArchive.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "libslam/files/files.h"
#include "libslam/logs/log_writer.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/testing/temp_folder.h"
#include "tests/mapping/small_room.h"

namespace slam::mapping {
namespace {

const std::string kSource = RASTERSLAM_SOURCE_DIR, kBinary = RASTERSLAM_BINARY_DIR;

std::string writeLog(const testing::TempFolder& folder, const test::Drive& drive) {
  std::string path = folder / "drive.rawlog";
  logs::LogWriter writer(path, rawlogs::RawlogForm::kActionFrame);
  for (const auto& entry : drive.entries) writer.write(entry);
  writer.close();
  return path;
}

/// Runs one of MRPT's programs in a folder, with `plugin` loaded and the same draws each time
/// (fixed_draws.cpp).
testing::CommandResult runIn(const testing::TempFolder& folder, const std::string& command,
                             const std::string& plugin = "") {
  return testing::runCommand("cd '" + folder.path() +
                             "' && env -u DISPLAY LD_PRELOAD='" RASTERSLAM_FIXED_DRAWS ":" + plugin + "' " +
                             command);
}

/// The numbers of the last line of a file that holds numbers.
std::vector<double> lastLine(const std::string& path) {
  std::istringstream lines(files::readTextFile(path));
  std::string line, last;
  while (std::getline(lines, line))
    if (line.find_first_of("0123456789") != std::string::npos) last = line;
  std::istringstream numbers(last);
  std::vector<double> values;
  for (double value = 0; numbers >> value;) values.push_back(value);
  return values;
}

core::Pose2 lastPoseOfIcpSlam(const std::string& log_folder) {
  const auto line = lastLine(log_folder + "/log_estimated_path.txt");  // step x y yaw
  return line.size() == 4 ? core::Pose2{line[1], line[2], line[3]} : core::Pose2{NAN, NAN, NAN};
}

core::Pose2 lastPoseOfRbpfSlam(const std::string& log_folder) {
  const auto line = lastLine(log_folder + "/log_estimated_path.txt");  // step x y z yaw pitch roll time
  return line.size() >= 5 ? core::Pose2{line[1], line[2], line[4]} : core::Pose2{NAN, NAN, NAN};
}

void expectNear(const core::Pose2& pose, const core::Pose2& truth, double distance_m, double angle_deg) {
  EXPECT_LT(core::distance(core::position(pose), core::position(truth)), distance_m);
  EXPECT_LT(std::abs(core::angleDifference(pose.phi, truth.phi)), core::degToRad(angle_deg));
}

TEST(StockPrograms, IcpSlamRunsOurConfigurationAndComesToTheSamePoseAsWe) {
  if (!testing::programExists("icp-slam"))
    GTEST_SKIP() << "icp-slam (Debian package mrpt-apps) is not installed";
  const testing::TempFolder folder;
  const auto drive = test::driveThroughRoom();
  const auto log = writeLog(folder, drive);
  const auto run = runIn(folder, "icp-slam '" + kSource + "/configs/mrpt/icp-slam.ini' '" + log + "'");
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  const auto pose = lastPoseOfIcpSlam(folder / "LOG_rasterslam_icp-slam");

  auto method = makeMapBuilder(loadMethodConfig(kSource + "/configs/methods", "icp"), "icp", 1);
  core::Pose2 ours;
  for (const auto& entry : drive.entries)
    ours = processScan(method, entry.scan, entry.T_previous_robot, entry.has_odometry);
  // The program writes 4 decimals; the log's odometry is in single precision.
  expectNear(pose, ours, 1e-3, 0.05);
  expectNear(pose, drive.truth.back(), 0.06, 0.7);
}

TEST(StockPrograms, RbpfSlamRunsOurConfigurationAndWithThePluginOurGrid) {
  if (!testing::programExists("rbpf-slam"))
    GTEST_SKIP() << "rbpf-slam (Debian package mrpt-apps) is not installed";
  const testing::TempFolder folder;
  const auto drive = test::driveThroughRoom();
  const auto log = writeLog(folder, drive);
  const std::string log_folder = folder / "LOG_rasterslam_rbpf-slam";

  const auto stock = runIn(folder, "rbpf-slam '" + kSource + "/configs/mrpt/rbpf-slam.ini' '" + log + "'");
  ASSERT_EQ(stock.exit_code, 0) << stock.out << stock.err;
  const auto stock_pose = lastPoseOfRbpfSlam(log_folder);
  EXPECT_TRUE(core::isFinite(stock_pose));

  const std::string exact_run = "rbpf-slam '" + kSource + "/configs/mrpt/rbpf-slam_exact.ini' '" + log + "'";
  const auto exact = runIn(folder, exact_run, kBinary + "/librasterslam-mrpt.so");
  ASSERT_EQ(exact.exit_code, 0) << exact.out << exact.err;
  const auto exact_pose = lastPoseOfRbpfSlam(log_folder);
  expectNear(exact_pose, drive.truth.back(), 0.1, 2);
  EXPECT_NE(exact_pose.phi, stock_pose.phi);
}

class SavedRun : public ::testing::Test {
 protected:
  void SetUp() override {
    auto method = makeMapBuilder(loadMethodConfig(kSource + "/configs/methods", "icp"), "icp", 1);
    core::Trajectory estimate;
    for (const auto& entry : test::driveThroughRoom(30).entries)
      estimate.push_back(
          {entry.scan.time_s, processScan(method, entry.scan, entry.T_previous_robot, entry.has_odometry)});
    saveMaps(method, folder_.path());
  }
  testing::TempFolder folder_;
};

TEST_F(SavedRun, TheSimpleMapIsReadByObservations2map) {
  if (!testing::programExists("observations2map"))
    GTEST_SKIP() << "observations2map (Debian package mrpt-apps) is not installed";
  const auto run =
      runIn(folder_, "observations2map '" + kSource +
                         "/configs/mrpt/robot-map-gui.ini' map.simplemap out -s MappingApplication");
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  bool found = false;
  for (const auto& file : std::filesystem::directory_iterator(folder_.path()))
    found = found || file.path().filename().string().find("COccupancyGridMap2D") != std::string::npos;
  EXPECT_TRUE(found) << run.out;
}

TEST_F(SavedRun, RobotMapGuisConfigurationMakesOurMapOfTheKeyFrames) {
  // As the program does behind File > Open simplemap and File > Load config; its window needs a screen.
  mrpt::maps::TSetOfMetricMapInitializers list;
  list.loadFromConfigFile(mrpt::config::CConfigFile(kSource + "/configs/mrpt/robot-map-gui.ini"),
                          "MappingApplication");
  mrpt::maps::CMultiMetricMap maps;
  maps.setListOfMaps(list);
  mrpt::maps::CSimpleMap frames;
  ASSERT_TRUE(frames.loadFromFile(folder_ / "map.simplemap"));
  maps.loadFromSimpleMap(frames);
  EXPECT_GT(maps.mapByClass<mrpt::maps::CSimplePointsMap>()->size(), 100U);
  const auto theirs = maps.mapByClass<mrpt::maps::COccupancyGridMap2D>();
  mrpt::maps::COccupancyGridMap2D ours;
  mrpt::io::CFileGZInputStream file(folder_ / "map.gridmap.gz");
  mrpt::serialization::archiveFrom(file) >> ours;
  int known = 0, same = 0;
  for (float x = -2; x < 6; x += 0.05f)
    for (float y = -3; y < 3; y += 0.05f) {
      const float a = ours.getPos(x, y), b = theirs->getPos(x, y);
      if (std::abs(a - 0.5f) < 0.2f) continue;
      ++known;
      same += (a > 0.5f) == (b > 0.5f);
    }
  EXPECT_GT(known, 5000);
  EXPECT_GT(same, 0.98 * known);
}

/// The last pose that pf-localization printed: "PDF estimation: (x,y,d.deg)".
core::Pose2 lastPoseOfPfLocalization(const std::string& printed) {
  const std::string words = "PDF estimation: (";
  const auto at = printed.rfind(words);
  core::Pose2 pose{NAN, NAN, NAN};
  double degrees = NAN;
  if (at != std::string::npos &&
      std::sscanf(printed.c_str() + at + words.size(), "%lf,%lf,%lf", &pose.x, &pose.y, &degrees) == 3)
    pose.phi = core::degToRad(degrees);
  return pose;
}

TEST_F(SavedRun, PfLocalizationFindsTheRobotInOurMap) {
  if (!testing::programExists("pf-localization"))
    GTEST_SKIP() << "pf-localization (Debian package mrpt-apps) is not installed";
  const auto drive = test::driveThroughRoom(30);
  const auto log = writeLog(folder_, drive);
  const std::string command =
      "pf-localization '" + kSource + "/configs/mrpt/pf-localization.ini' '" + log + "'";
  const auto run = runIn(folder_, command);
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  // Mostly 1 cm and 0.5 degrees; 14 cm and 4 degrees have been seen, and another MRPT may draw other
  // numbers; another place would be metres away.
  expectNear(lastPoseOfPfLocalization(run.out), drive.truth.back(), 0.3, 10);
  const auto again = runIn(folder_, command);
  EXPECT_EQ(lastPoseOfPfLocalization(again.out), lastPoseOfPfLocalization(run.out))
      << "fixed_draws.cpp no longer stands in for what seeds MRPT's generator";
}

}  // namespace
}  // namespace slam::mapping
