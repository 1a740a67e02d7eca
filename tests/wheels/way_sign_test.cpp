#include "libslam/wheels/way_sign.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace slam::wheels {
namespace {

const core::Pose2 kAhead{0.5, 0, 0.1}, kBehind{-0.5, 0, 0.1};

TEST(WaySign, AtFirstASignIsHardlyBelieved) {
  EXPECT_NEAR(WaySign().against(), std::log(2.7), 1e-12);
}

// A robot that went 100 m ahead goes ahead.
TEST(WaySign, MetresForwardsSayLittle) {
  WaySign sign;
  for (int i = 0; i < 200; ++i) sign.learn(kAhead, {0.45, 0.05, 0}, 1);
  EXPECT_NEAR(sign.against(), std::log(12.7), 1e-2);
}

TEST(WaySign, WheelsThatCountAMetreBackwardsKnowTheirSign) {
  WaySign sign;
  for (int i = 0; i < 20; ++i) sign.learn(kBehind, {-0.45, 0.05, 0}, 1);
  EXPECT_NEAR(sign.against(), std::log(102.7), 1e-9);
}

TEST(WaySign, MetresThatWentTheOtherWaySpeakAgainstIt) {
  WaySign sign;
  for (int i = 0; i < 16; ++i) sign.learn(kBehind, kBehind, 1);
  for (int i = 0; i < 40; ++i) sign.learn(kAhead, {-0.55, 0.02, 0}, 1);
  // 8 m that count ten times, and 20 m the other way.
  EXPECT_NEAR(sign.against(), std::log(102.7 / 21), 1e-9);
}

TEST(WaySign, NothingIsLearntWhereNothingTells) {
  WaySign sign;
  for (int i = 0; i < 100; ++i) {
    sign.learn(kAhead, kAhead, 0.4);  // odometry's own word
    sign.learn({}, {}, 1);            // standing
    sign.learn({30, 0, 0}, {30, 0, 0}, 1);
    sign.learn(kAhead, {0.1, 0, 0}, 1);  // neither way: wheels that slip
    sign.learn(kAhead, {std::numeric_limits<double>::quiet_NaN(), 0, 0}, 1);
    sign.learn({std::numeric_limits<double>::infinity(), 0, 0}, kAhead, 1);
  }
  EXPECT_NEAR(sign.against(), std::log(2.7), 1e-12);
}

}  // namespace
}  // namespace slam::wheels
