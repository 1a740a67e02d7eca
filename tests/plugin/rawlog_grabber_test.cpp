// The simulated lidar inside MRPT's own recorder, with the committed configuration.
#include <gtest/gtest.h>
#include <mrpt/config/CConfigFile.h>
#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/hwdrivers/CGenericSensor.h>

#include <filesystem>
#include <fstream>
#include <regex>

#include "libslam/files/files.h"
#include "libslam/logs/log_reader.h"
#include "libslam/plugin/exploring_robot.h"
#include "libslam/plugin/simulated_lidar.h"
#include "libslam/testing/temp_folder.h"
#include "tests/plugin/readings.h"

namespace slam::plugin {
namespace {

namespace fs = std::filesystem;
const std::string kConfig = std::string(RASTERSLAM_SOURCE_DIR) + "/configs/mrpt/rawlog-grabber.ini";
const std::string kPlugin = std::string(RASTERSLAM_BINARY_DIR) + "/librasterslam-sensor.so";

/// The committed configuration with one key changed (`key = ...` up to the line's end), which must be in it.
std::string withKey(const std::string& text, const std::string& key, const std::string& value) {
  const std::regex line("(^|\n)" + key + " = [^\n]*");
  EXPECT_TRUE(std::regex_search(text, line)) << key;
  return std::regex_replace(text, line, "$01" + key + " = " + value);
}

mrpt::hwdrivers::CGenericSensor::Ptr makeSensor() {
  registerSensors();
  return mrpt::hwdrivers::CGenericSensor::createSensorPtr("SimulatedLidar");
}

/// Runs the recorder until the sensor has said that it is done. The recorder ends at a key on its standard
/// input, which therefore has to stay open until then. The limits only matter when something is broken.
testing::CommandResult grab(const testing::TempFolder& folder, const std::string& config) {
  std::ofstream(folder / "grab.ini") << config;
  return testing::runCommand("cd '" + folder.path() + "' && mkfifo done && timeout 600 head -c 1 done | " +
                             "timeout 600 rawlog-grabber -p '" + kPlugin + "' grab.ini");
}

std::string recordedLog(const testing::TempFolder& folder) {
  for (const auto& file : fs::directory_iterator(folder.path()))
    if (file.path().extension() == ".rawlog") return file.path().string();
  return "";
}

TEST(SimulatedLidar, TakesTheCommittedConfiguration) {
  const auto sensor = makeSensor();
  ASSERT_TRUE(sensor);
  sensor->loadConfig(mrpt::config::CConfigFile(kConfig), "LIDAR");
  EXPECT_EQ(sensor->getSensorLabel(), "LASER");
  sensor->initialize();
  EXPECT_EQ(sensor->getState(), mrpt::hwdrivers::CGenericSensor::ssWorking);
}

TEST(SimulatedLidar, RunsAtTheRealTimeFactorOrElseAtTheProcessRate) {
  for (const auto& [factor, rate_hz] : {std::pair{"0", 25.0}, {"1", 10.0}, {"3", 30.0}}) {
    const auto sensor = makeSensor();
    const std::string text =
        std::string("[S]\nprocess_rate = 25\nlidar.rate_hz = 10\nreal_time_factor = ") + factor;
    sensor->loadConfig(mrpt::config::CConfigFileMemory(text), "S");
    EXPECT_DOUBLE_EQ(sensor->getProcessRate(), rate_hz) << factor;
  }
}

TEST(SimulatedLidar, GivesOdometryAndScanPerCallAndThenIsSilent) {
  const testing::TempFolder folder;
  const auto sensor = makeSensor();
  const std::string text =
      "[S]\nprocess_rate = 5\nsensorLabel = front\nscans = 2 // comment\nplan = flat # comment\n";
  sensor->loadConfig(mrpt::config::CConfigFileMemory(text + "done_file = " + folder / "done"), "S");
  sensor->initialize();
  for (int call = 0; call < 2; ++call) {
    sensor->doProcess();
    EXPECT_EQ(sensor->getObservations().size(), 2U);
    EXPECT_FALSE(fs::exists(folder / "done"));
  }
  sensor->doProcess();
  sensor->doProcess();
  EXPECT_TRUE(sensor->getObservations().empty());
  EXPECT_EQ(files::readTextFile(folder / "done"), "done\n");
}

class RawlogGrabber : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!testing::programExists("rawlog-grabber"))
      GTEST_SKIP() << "rawlog-grabber (Debian package mrpt-apps) is not installed";
    if (!fs::exists(kPlugin)) GTEST_SKIP() << kPlugin << " is not built (it is not in a sanitized build)";
  }
};

TEST_F(RawlogGrabber, RecordsTheSimulatedLidar) {
  constexpr int kScans = 120;
  const testing::TempFolder folder;
  std::string config = files::readTextFile(kConfig);
  config = withKey(config, "scans", std::to_string(kScans) + "\ndone_file = done");
  config = withKey(config, "real_time_factor", "40");
  config = withKey(config, "GRABBER_PERIOD_MS", "20");
  const auto run = grab(folder, config);
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_EQ(run.err.find("Exception"), std::string::npos) << run.err;

  const auto ini =
      files::IniFile::parse("[LIDAR]\nplan = flat\nlidar = utm30lx\nstrategy = quadrant\n", "twin");
  ExploringRobot twin(readExploringRobotOptions(ini, "LIDAR"));
  logs::LogReader log(recordedLog(folder));
  int scans = 0;
  double last_time_s = 0;
  for (; const auto entry = log.next(); ++scans) {
    const auto sensed = twin.next();
    ASSERT_TRUE(sensed);
    EXPECT_GT(entry->scan.time_s, last_time_s);
    last_time_s = entry->scan.time_s;
    EXPECT_EQ(entry->scan.time_s, sensed->scan.time_s);
    EXPECT_TRUE(entry->has_odometry);
    EXPECT_LT(core::distance(entry->T_odom_robot, sensed->T_odom_robot), 1e-9);
    EXPECT_EQ(test::differingReadings(entry->scan, sensed->scan), 0) << scans;
  }
  EXPECT_EQ(log.sensorLabel(), "LASER");
  EXPECT_LE(scans, kScans);
  // Each time it writes, the recorder leaves half of what it holds for the next time, and never gets it out
  // at the end: half of all is certain, whatever the machine's load.
  EXPECT_GE(scans, kScans / 2);
  EXPECT_LE(log.counts().odometry_readings, static_cast<std::uint64_t>(scans) + 1);
}

TEST_F(RawlogGrabber, RecordsAStrategyThatNeedsAMap) {
  const testing::TempFolder folder;
  std::string config = files::readTextFile(kConfig);
  config = withKey(config, "strategy", "nearest_frontier");
  config = withKey(config, "scans", "60\ndone_file = done");
  config = withKey(config, "real_time_factor", "40");
  config = withKey(config, "GRABBER_PERIOD_MS", "20");
  const auto run = grab(folder, config);
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_EQ((run.out + run.err).find("Exception"), std::string::npos) << run.out << run.err;
  EXPECT_EQ((run.out + run.err).find("seeMap"), std::string::npos) << run.out << run.err;
  logs::LogReader log(recordedLog(folder));
  int scans = 0;
  while (log.next()) ++scans;
  EXPECT_GE(scans, 30);  // of 60; see above
}

TEST_F(RawlogGrabber, ShowsOurErrorForAMisspeltKey) {
  const testing::TempFolder folder;
  const auto run =
      testing::runCommand("cd '" + folder.path() + "' && sed 's/^plan = /plann = /' '" + kConfig +
                          "' >grab.ini && mkfifo open && " + "{ timeout 600 rawlog-grabber -p '" + kPlugin +
                          "' grab.ini <>open; }");
  EXPECT_NE((run.out + run.err).find("section LIDAR, unknown key 'plann'; did you mean 'plan'?"),
            std::string::npos)
      << run.out << run.err;
}

}  // namespace
}  // namespace slam::plugin
