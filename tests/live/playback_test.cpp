#include "libslam/live/playback.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/error.h"

namespace slam::live {
namespace {

TEST(Playback, KeepsToTheRobotsTimeAtItsSpeed) {
  Playback playback(4);
  EXPECT_EQ(playback.waitFor(10, 100), 0);  // the first begins at once
  EXPECT_DOUBLE_EQ(playback.waitFor(12, 100), 0.5);
  EXPECT_DOUBLE_EQ(playback.waitFor(12, 100.25), 0.25);
  EXPECT_EQ(playback.waitFor(12, 100.5), 0);
}

TEST(Playback, DoesNotCatchUpWithAStepThatWasLate) {
  Playback playback(1);
  playback.waitFor(0, 0);
  EXPECT_EQ(playback.waitFor(1, 10), 0);
  EXPECT_DOUBLE_EQ(playback.waitFor(2, 10), 1);  // from the late one on, not at once
}

TEST(Playback, AsFastAsItGoesNeverWaits) {
  Playback playback(0);
  for (int step = 0; step < 5; ++step) EXPECT_EQ(playback.waitFor(step, 0), 0);
  EXPECT_EQ(playback.text(), "as fast as it goes");
}

TEST(Playback, PausedOnlyStepsThatWereAskedForBegin) {
  Playback playback(1);
  playback.stepOnce();  // while it runs: pauses
  EXPECT_TRUE(playback.paused());
  EXPECT_TRUE(std::isinf(playback.waitFor(0, 0)));
  playback.stepOnce();
  playback.stepOnce();
  EXPECT_EQ(playback.waitFor(0, 0), 0);
  playback.began();
  EXPECT_EQ(playback.waitFor(1, 0), 0);
  playback.began();
  EXPECT_TRUE(std::isinf(playback.waitFor(2, 1000)));
  EXPECT_EQ(playback.text(), "paused");
}

TEST(Playback, ThePauseIsNotCaughtUpWith) {
  Playback playback(1);
  playback.waitFor(0, 0);
  playback.togglePause();
  playback.togglePause();
  EXPECT_EQ(playback.waitFor(1, 100), 0);
  EXPECT_DOUBLE_EQ(playback.waitFor(2, 100), 1);
}

TEST(Playback, SpeedsGoFromAnEighthToAsFastAsItGoesAndBack) {
  Playback playback(4);
  for (int i = 0; i < 20; ++i) playback.slower();
  EXPECT_EQ(playback.text(), "0.125 x real time");
  for (int i = 0; i < 9; ++i) playback.faster();
  EXPECT_EQ(playback.text(), "64 x real time");
  playback.faster();
  playback.faster();
  EXPECT_EQ(playback.speed(), 0);
  playback.slower();
  EXPECT_EQ(playback.speed(), Playback::kFastest);
}

TEST(Playback, RefusesSpeedsThatItDoesNotHave) {
  EXPECT_THROW(Playback(-1), core::ContractError);
  EXPECT_THROW(Playback(0.1), core::ContractError);
  EXPECT_THROW(Playback(std::nan("")), core::ContractError);
}

}  // namespace
}  // namespace slam::live
