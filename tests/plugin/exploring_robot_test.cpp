#include "libslam/plugin/exploring_robot.h"

#include <gtest/gtest.h>

#include "libslam/core/error.h"
#include "libslam/logs/log_reader.h"
#include "libslam/resources/resources.h"
#include "libslam/testing/temp_folder.h"
#include "tests/plugin/readings.h"

namespace slam::plugin {
namespace {

ExploringRobotOptions read(const std::string& lines) {
  return readExploringRobotOptions(files::IniFile::parse("[LIDAR]\n" + lines, "grab.ini"), "LIDAR");
}

std::string errorOf(const std::string& lines) {
  try {
    ExploringRobot robot(read(lines));
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ExploringRobot, SensesWhatARecordingOfTheSameSeedHolds) {
  const testing::TempFolder folder;
  const std::string same = "plan = flat\nlidar = rplidar_a1\nstrategy = longest_ray\nseed = 7\n";
  auto options = read(same + "scans = 60\n");
  options.record.simulation.duration_s = 60 / options.record.lidar.rate_hz;
  const auto plan = world::loadPlan(resources::resolvePlan("flat"));
  record::record(plan, options.record, 7, folder / "run.rawlog", {}, core::silentProgress());

  logs::LogReader log(folder / "run.rawlog");
  ExploringRobot robot(options);
  for (int i = 0; i < 60; ++i) {
    const auto sensed = robot.next();
    const auto entry = log.next();
    ASSERT_TRUE(sensed && entry) << i;
    EXPECT_EQ(sensed->scan.time_s, entry->scan.time_s);
    // The log holds increments in single precision.
    EXPECT_LT(core::distance(sensed->T_odom_robot, entry->T_odom_robot), 1e-4);
    EXPECT_EQ(test::differingReadings(sensed->scan, entry->scan), 0) << i;
  }
  EXPECT_FALSE(robot.next());
  EXPECT_FALSE(robot.next());  // and stays silent
}

TEST(ExploringRobot, PassesDottedKeysOnToTheSimulation) {
  const auto options =
      read("lidar = utm30lx\nlidar.beams = 91\nrobot.side_m = 0.3\nstrategy = longest_ray\n");
  EXPECT_EQ(options.record.lidar.beams, 91);
  EXPECT_EQ(options.record.robot.side_m, 0.3);
  EXPECT_EQ(options.record.strategy.name, "longest_ray");
  EXPECT_EQ(ExploringRobot(options).next()->scan.ranges_m.size(), 91U);
}

TEST(ExploringRobot, MapsItsOwnScansForAStrategyThatNeedsAMapAndExploresToTheEnd) {
  const std::string lines =
      "plan = flat\nlidar = utm30lx\nlidar.beams = 181\nstrategy = nearest_frontier\nseed = 3\n";
  ExploringRobot robot(read(lines)), twin(read(lines + "slam = graph\n"));
  int scans = 0;
  core::Pose2 last;
  double driven_m = 0;
  constexpr int kFarTooMany = 20000;
  for (; scans < kFarTooMany; ++scans) {
    const auto sensed = robot.next();
    if (!sensed) break;
    driven_m += scans > 0 ? core::distance(last, sensed->T_odom_robot) : 0;
    last = sensed->T_odom_robot;
    if (scans >= 100) continue;
    EXPECT_EQ(test::differingReadings(sensed->scan, twin.next()->scan), 0) << scans;
  }
  EXPECT_LT(scans, kFarTooMany) << "nothing was left to explore";
  EXPECT_GT(driven_m, 20) << "the flat has more than one room";
}

TEST(ExploringRobot, SaysWhatIsWrongWithItsConfiguration) {
  EXPECT_EQ(errorOf("plann = flat\n"),
            "grab.ini:2: section [LIDAR], unknown key 'plann'; did you mean 'plan'?");
  EXPECT_EQ(errorOf("plan = flatt\n").substr(0, 46), "flatt: no such file and no world of that name;");
  EXPECT_EQ(
      errorOf("scans = -1\n"),
      "grab.ini:2: section [LIDAR], key 'scans': found '-1', expected a whole number from 0 to 1000000000");
  EXPECT_NE(errorOf("lidar = utm30l\n").find("did you mean 'utm30lx'?"), std::string::npos);
  EXPECT_NE(errorOf("strategy = nearest_frontier\nslam = grap\n").find("did you mean 'graph'?"),
            std::string::npos)
      << errorOf("strategy = nearest_frontier\nslam = grap\n");
  EXPECT_NE(errorOf("lidar.beam = 5\n").find("did you mean 'beams'?"), std::string::npos);
  EXPECT_NE(errorOf("lidr.beams = 5\n").find("did you mean 'lidar'?"), std::string::npos);
  EXPECT_NE(errorOf("start = 0 0 0\n").find("start pose (0.000 m, 0.000 m, 0.0 deg) is"), std::string::npos);
}

}  // namespace
}  // namespace slam::plugin
