#include "libslam/record/sensor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libslam/core/error.h"
#include "libslam/reach/reach_goal.h"
#include "libslam/record/record.h"

namespace slam::record {
namespace {

files::IniFile ini(const std::string& text) {
  return files::IniFile::parse(text, "a.ini");
}

std::string errorOf(const std::string& text) {
  try {
    readRecordConfig(ini(text));
  } catch (const core::InputError& e) {
    return e.what();
  }
  return "";
}

TEST(Sensors, AreALidarUnlessACameraIsAskedFor) {
  EXPECT_FALSE(readRecordConfig(ini("")).camera);
  EXPECT_EQ(readRecordConfig(ini("[lidar]\nbeams = 100\n")).lidar.beams, 100);
  const auto config = readRecordConfig(ini("[sensor]\nkind = camera\n[camera]\npitch_deg = 30\n"));
  ASSERT_TRUE(config.camera);
  EXPECT_NEAR(config.camera->view.pitch_rad, core::degToRad(30), 1e-12);
  EXPECT_EQ(config.lidar.max_range_m, robot::asLidar(*config.camera).max_range_m);
  EXPECT_TRUE(reach::readReachGoalConfig(ini("[sensor]\nkind = camera\n")).camera);
}

TEST(Sensors, WithANarrowViewDriveByTheLocalObstacleMapUnlessToldOtherwise) {
  EXPECT_EQ(readRecordConfig(ini("")).strategy.memory, "none");
  EXPECT_EQ(readRecordConfig(ini("[sensor]\nkind = camera\n")).strategy.memory, "local_map");
  EXPECT_EQ(readRecordConfig(ini("[sensor]\nkind = camera\n")).strategy.unseen, "looked_at");
  EXPECT_EQ(reach::readReachGoalConfig(ini("[sensor]\nkind = camera\n")).navigate.memory, "local_map");
  EXPECT_EQ(reach::readReachGoalConfig(ini("[sensor]\nkind = camera\n")).navigate.unseen, "looked_at");
  EXPECT_EQ(reach::readReachGoalConfig(ini("")).navigate.unseen, "free");
  const std::string told = "[sensor]\nkind = camera\n[strategy]\nmemory = none\n";
  EXPECT_EQ(readRecordConfig(ini(told)).strategy.memory, "none");
  EXPECT_EQ(
      readRecordConfig(ini("[sensor]\nkind = camera\n[obstacles]\nfront_m = 3\n")).strategy.obstacles.front_m,
      3);
}

TEST(Sensors, WithADeadZoneStopBeforeIt) {
  // Ymin = 0.1 + 0.458 m from the robot's centre; CanMove with the 0.45 m of a lidar would ask for what is
  // never seen.
  const auto config = readRecordConfig(ini("[sensor]\nkind = camera\n"));
  EXPECT_NEAR(config.strategy.stop_clearance_m, 0.558 + config.robot.max_speed_mps / 5, 0.01);
  EXPECT_EQ(readRecordConfig(ini("[sensor]\nkind = camera\n[strategy]\nstop_clearance_m = 0.3\n"))
                .strategy.stop_clearance_m,
            0.3);
}

TEST(Sensors, RefuseWhatTheOtherOneHas) {
  EXPECT_EQ(
      errorOf("[sensor]\nkind = camera\n[lidar]\nbeams = 100\n"),
      "section [lidar]: has no effect with section [sensor], key 'kind': 'camera', expected lidar there");
  EXPECT_EQ(
      errorOf("[camera]\npitch_deg = 30\n"),
      "section [camera]: has no effect with section [sensor], key 'kind': 'lidar', expected camera there");
}

TEST(Sensors, RefuseACameraThatSeesNoFloorOrHasNoSuchLens) {
  const std::string camera = "[sensor]\nkind = camera\n[camera]\n";
  EXPECT_THAT(errorOf(camera + "pitch_deg = -40\n"),
              ::testing::StartsWith("section [camera], key 'pitch_deg': found '-40'"));
  for (const char* key : {"fov_x_deg", "fov_y_deg"})
    for (const char* value : {"0", "180", "-10"})
      EXPECT_THAT(errorOf(camera + key + " = " + value + "\n"),
                  ::testing::HasSubstr("key '" + std::string(key) + "'"));
  EXPECT_THAT(errorOf(camera + "pich_deg = 3\n"), ::testing::HasSubstr("did you mean 'pitch_deg'"));
}

}  // namespace
}  // namespace slam::record
