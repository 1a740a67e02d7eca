#include "libslam/wheels/silence.h"

#include <gtest/gtest.h>

namespace slam::wheels {
namespace {

TEST(Silence, WheelsThatNeverTurnedSayNothing) {
  Silence silence;
  int noted = 0;
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(silence.take({})) << i;
    noted += silence.note({0.1, 0, 0});
  }
  EXPECT_EQ(noted, 1);
}

TEST(Silence, EndsWithTheFirstStepForGood) {
  Silence silence;
  EXPECT_TRUE(silence.take({}));
  EXPECT_FALSE(silence.note({0.001, 0, 0}));
  for (const core::Pose2& step :
       {core::Pose2{0, 0, -1e-6}, core::Pose2{}, core::Pose2{0.1, 0, 0}, core::Pose2{}}) {
    EXPECT_FALSE(silence.take(step));
    EXPECT_FALSE(silence.note({1, 0, 0}));
  }
}

// Matches of a robot that waits scatter.
TEST(Silence, ARobotThatStandsIsNotSeenToMove) {
  Silence silence;
  for (int i = 0; i < 1000; ++i) {
    const core::Pose2 jitter{0.1, 0, 0.1};
    ASSERT_TRUE(silence.take({})) << i;
    ASSERT_FALSE(silence.note(i % 2 ? core::inverse(jitter) : jitter)) << i;
  }
}

}  // namespace
}  // namespace slam::wheels
