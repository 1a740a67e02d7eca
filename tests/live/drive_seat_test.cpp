#include "libslam/live/drive_seat.h"

#include <gtest/gtest.h>

namespace slam::live {
namespace {

robot::UserCommand move(double distance_m) {
  return {robot::UserCommand::kMove, distance_m, 1};
}

class DriveSeatTest : public ::testing::Test {
 protected:
  DriveSeat seat(const std::vector<robot::UserCommand>& commands, Stage* stage, bool ends = false) {
    return {robot_, 0.2, commands, stage, ends};
  }
  double distanceOf(const std::optional<record::Order>& order) const {
    return order->command.speed_mps * order->command.duration_s;
  }
  robot::RobotOptions robot_;
  Stage stage_{Playback(0)};
};

TEST_F(DriveSeatTest, WholeCommandsComeBeforeTheKeysInTheirOrder) {
  stage_.give(move(3));
  HeldKeys keys;
  keys.ahead = true, keys.share = 1;
  stage_.setKeys(keys);
  auto driver = seat({move(1), move(-2)}, &stage_);
  for (const double distance_m : {1.0, -2.0, 3.0}) {
    const auto order = driver.next(false);
    EXPECT_NEAR(distanceOf(order), distance_m, 1e-12);
    EXPECT_TRUE(order->is_whole);
  }
  EXPECT_NEAR(distanceOf(driver.next(false)), 0.2 * robot_.max_speed_mps, 1e-12);
}

TEST_F(DriveSeatTest, EndsWithItsCommandsWhereNobodyElseDrives) {
  auto alone = seat({move(1)}, nullptr), closing = seat({move(1)}, &stage_, true);
  for (auto* driver : {&alone, &closing}) {
    EXPECT_TRUE(driver->next(false));
    EXPECT_FALSE(driver->next(false));
  }
  auto staying = seat({move(1)}, &stage_);
  staying.next(false);
  EXPECT_TRUE(staying.next(false));
  stage_.close();
  EXPECT_FALSE(staying.next(false));
}

TEST_F(DriveSeatTest, WhatWasAskedForBeforeTheWindowWasClosedIsDone) {
  auto driver = seat({move(1), move(1)}, &stage_);
  stage_.carry({1, 2, 0});
  stage_.give(move(3));
  stage_.close();
  const auto order = driver.next(false);
  ASSERT_TRUE(order);
  EXPECT_NEAR(distanceOf(order), 3, 1e-12);
  EXPECT_TRUE(order->T_world_carried);
  EXPECT_FALSE(driver.next(false));  // the file's commands are not
}

TEST_F(DriveSeatTest, TheRobotIsCarriedOnceBeforeTheNextCommand) {
  auto driver = seat({}, &stage_);
  stage_.carry({1, 2, 0});
  stage_.carry({3, 4, 0});  // put down again before the loop came round
  const auto order = driver.next(false);
  ASSERT_TRUE(order->T_world_carried);
  EXPECT_EQ(order->T_world_carried->x, 3);
  EXPECT_FALSE(driver.next(false)->T_world_carried);
}

}  // namespace
}  // namespace slam::live
