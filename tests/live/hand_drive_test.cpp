#include "libslam/live/hand_drive.h"

#include <gtest/gtest.h>

namespace slam::live {
namespace {

class HandDriveTest : public ::testing::Test {
 protected:
  static HeldKeys held(bool ahead, bool back, bool left, bool right) { return {ahead, back, left, right, 1}; }

  robot::RobotOptions robot_;
  HandDrive hand_{robot_, 0.2};
};

TEST_F(HandDriveTest, KeysAreSpeeds) {
  const auto ahead = hand_.next(held(true, false, false, false), false);
  EXPECT_EQ(ahead.speed_mps, robot_.max_speed_mps);
  EXPECT_EQ(ahead.turn_rate_radps, 0);
  EXPECT_EQ(ahead.duration_s, 0.2);
  const auto arc = hand_.next(held(false, true, false, true), false);
  EXPECT_EQ(arc.speed_mps, -robot_.max_speed_mps);
  EXPECT_EQ(arc.turn_rate_radps, -robot_.max_turn_rate_radps);
  HeldKeys slowly = held(true, false, true, false);
  slowly.share = 0.25;
  EXPECT_EQ(hand_.next(slowly, false).speed_mps, 0.25 * robot_.max_speed_mps);
  EXPECT_EQ(hand_.next(slowly, false).turn_rate_radps, 0.25 * robot_.max_turn_rate_radps);
}

TEST_F(HandDriveTest, OppositeKeysCancelAndNoneStandsStill) {
  for (const auto& keys : {held(true, true, true, true), held(false, false, false, false)}) {
    const auto command = hand_.next(keys, false);
    EXPECT_EQ(command.speed_mps, 0);
    EXPECT_EQ(command.turn_rate_radps, 0);
    EXPECT_EQ(command.duration_s, 0.2);  // time passes
  }
}

TEST_F(HandDriveTest, AfterACollisionItStaysUntilTheKeyIsLetGo) {
  const auto ahead = held(true, false, false, false);
  hand_.next(ahead, false);
  EXPECT_EQ(hand_.next(ahead, true).speed_mps, 0);
  EXPECT_EQ(hand_.next(ahead, false).speed_mps, 0);
  const auto turning = hand_.next(held(true, false, true, false), false);
  EXPECT_EQ(turning.speed_mps, 0);
  EXPECT_GT(turning.turn_rate_radps, 0);
  hand_.next(held(false, false, false, false), false);
  EXPECT_GT(hand_.next(ahead, false).speed_mps, 0);
}

TEST_F(HandDriveTest, AfterACollisionItMayGoTheOtherWayAtOnce) {
  hand_.next(held(true, false, false, false), false);
  EXPECT_LT(hand_.next(held(false, true, false, false), true).speed_mps, 0);
}

TEST_F(HandDriveTest, WhoeverRunsIntoAStandingRobotDoesNotBlockIt) {
  hand_.next(held(false, false, false, false), false);
  EXPECT_GT(hand_.next(held(true, false, false, false), true).speed_mps, 0);
}

}  // namespace
}  // namespace slam::live
