#include "libslam/record/user_drive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libslam/files/files.h"
#include "libslam/logs/log_reader.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/resources/resources.h"
#include "libslam/sim/operation_log.h"
#include "libslam/testing/temp_folder.h"
#include "libslam/truth/carry_file.h"

namespace slam::record {
namespace {

class UserDriveTest : public ::testing::Test {
 protected:
  UserDriveTest() {
    ini_.set("lidar", "beams", "181", "test");
    ini_.set("simulation", "start", "3 3 0", "test");
  }
  UserDrive drive(const std::string& commands) {
    return recordUserCommands(world::loadPlan(resources::resolvePlan("flat")), readRecordConfig(ini_), 4,
                              folder_ / "run.rawlog", robot::parseUserCommands(commands, "test"), {},
                              core::silentProgress());
  }
  std::vector<sim::Operation> operations() const {
    return sim::parseOperations(files::readTextFile(folder_ / "run.operations.txt"), "operations");
  }

  const testing::TempFolder folder_{};
  files::IniFile ini_;
};

TEST_F(UserDriveTest, OneScanAndOneEntryOfTheLogPerWholeCommand) {
  const auto result = drive("move 0.5\nturn 90\nmove -0.25\nmove -0.25\n");
  EXPECT_EQ(result.recording.scans, 5U);
  logs::LogReader log(folder_ / "run.rawlog");
  int scans = 0;
  while (log.next()) ++scans;
  EXPECT_EQ(scans, 5);
  std::string kinds;
  for (const auto& operation : operations()) kinds += operation.kind;
  EXPECT_EQ(kinds, "mtmm");  // two alike stay two
  const auto truth = logs::readTum(folder_ / "run.gt.tum");
  ASSERT_EQ(truth.size(), 5U);
  EXPECT_NEAR(truth[1].pose.x, 3.5, 1e-5);
  EXPECT_NEAR(truth[2].pose.phi, core::kPi / 2, 1e-5);
  EXPECT_NEAR(truth[3].pose.y, 2.75, 1e-5);
  EXPECT_NEAR(truth[4].pose.y, 2.5, 1e-5);
  for (const auto& outcome : result.outcomes) {
    EXPECT_FALSE(outcome.collided);
    EXPECT_NEAR(outcome.done, outcome.command.amount, 1e-9);
    EXPECT_EQ(outcomeText(outcome), "");
  }
}

TEST_F(UserDriveTest, AMoveThatMeetsAWallEndsThereAndTheNextGoesOn) {
  const auto result = drive("turn 180\n\nmove 50\nmove -0.5\n");
  ASSERT_EQ(result.outcomes.size(), 3U);
  EXPECT_FALSE(result.outcomes[0].collided);
  EXPECT_TRUE(result.outcomes[1].collided);
  EXPECT_GT(result.outcomes[1].done, 0.5);
  EXPECT_LT(result.outcomes[1].done, 3);
  EXPECT_THAT(outcomeText(result.outcomes[1]),
              ::testing::StartsWith("line 3: move 50 ended at an obstacle after "));
  EXPECT_NEAR(result.outcomes[2].done, -0.5, 1e-9);
  EXPECT_EQ(result.recording.collisions.size(), 1U);
  EXPECT_EQ(result.recording.scans, 4U);
}

TEST_F(UserDriveTest, WhatTheDurationCutsOffIsLeft) {
  ini_.set("simulation", "duration_s", "1", "test");
  const auto result = drive("move 0.6\nmove 0.6\nmove 0.6\nmove 0.6\n");
  EXPECT_GT(result.outcomes.size(), 0U);
  EXPECT_LT(result.outcomes.size(), 4U);
}

TEST_F(UserDriveTest, ACarryIsNoCommandAndNoWay) {
  ini_.set("events", "carry", "1:11,3,90", "test");
  const auto result = drive("move 1\nmove 0.5\n");
  EXPECT_EQ(operations().size(), 2U);
  EXPECT_EQ(result.recording.scans, 3U);
  EXPECT_NEAR(result.recording.path_length_m, 1.5, 1e-6);
  const auto truth = logs::readTum(folder_ / "run.gt.tum");
  EXPECT_NEAR(truth.back().pose.x, 11, 1e-5);
  EXPECT_GT(truth.back().pose.y, 3.4);
  const auto carries = truth::readCarryFile(truth::carriesPath(folder_ / "run.rawlog"));
  ASSERT_EQ(carries.size(), 1U);
  EXPECT_NEAR(carries[0].time_s - truth.front().time_s, 1, 1e-3);
  EXPECT_EQ(carries[0].T_world_to.x, 11);
  EXPECT_EQ(truth::carryText(carries[0], truth.front().time_s).substr(0, 19), "kidnapped at 1.0 s ");
  double odometry_m = 0;
  logs::LogReader log(folder_ / "run.rawlog");
  while (const auto entry = log.next()) odometry_m = entry->T_odom_robot.x;
  EXPECT_NEAR(odometry_m, 1.5, 0.2);  // the wheels turned as told
  ini_.set("events", "carry", "none", "test");
  drive("move 1\n");
  EXPECT_TRUE(truth::readCarryFile(truth::carriesPath(folder_ / "run.gt.tum"))
                  .empty());  // that of the drive before is gone
}

}  // namespace
}  // namespace slam::record
