#include "libslam/live/stage.h"

#include <gtest/gtest.h>

#include <thread>

#include "libslam/core/error.h"

namespace slam::live {
namespace {

lidar::Scan someScan() {
  lidar::Scan scan;
  scan.step_rad = 0.1, scan.max_range_m = 10;
  scan.ranges_m.assign(5, 1.0F);
  return scan;
}

TEST(Stage, GivesTheNewestMomentOnce) {
  Stage stage(Playback(0));
  EXPECT_FALSE(stage.take());
  EXPECT_TRUE(stage.isWanted());
  viewer::Snapshot snapshot;
  snapshot.scans = 1;
  stage.publish(snapshot);
  EXPECT_FALSE(stage.isWanted());
  snapshot.scans = 2;
  stage.publish(snapshot);
  EXPECT_EQ(stage.take()->scans, 2U);
  EXPECT_FALSE(stage.take());
}

TEST(Stage, APausedLoopGoesOnWhenAStepIsAskedFor) {
  Stage stage(Playback(1, true));
  int told = 0;
  bool went_on = false;
  std::thread loop([&] { went_on = stage.waitForStep(0, [&] { ++told; }); });
  stage.change([](Playback& playback) { playback.stepOnce(); });
  loop.join();
  EXPECT_TRUE(went_on);
  EXPECT_LE(told, 1);
}

TEST(Stage, AClosedWindowFreesAPausedLoop) {
  Stage stage(Playback(1, true));
  bool went_on = true;
  std::thread loop([&] { went_on = stage.waitForStep(0, [] {}); });
  stage.close();
  loop.join();
  EXPECT_FALSE(went_on);
}

TEST(StagedLoop, EndsAWatchedLoopAndLetsADrivenOneSave) {
  SnapshotMaker maker("", "", {});
  const auto scan = someScan();
  for (const bool interrupts : {true, false}) {
    Stage stage(Playback(0));
    StagedLoop loop(stage, maker, interrupts);
    loop.onStep({0, scan, {}, {}});
    EXPECT_TRUE(stage.take());
    stage.close();
    if (interrupts)
      EXPECT_THROW(loop.onStep({1, scan, {}, {}}), core::Interrupted);
    else
      EXPECT_NO_THROW(loop.onStep({1, scan, {}, {}}));
  }
}

TEST(MomentAt, KeepsTheFirstMomentThatIsNotBefore) {
  SnapshotMaker maker("", "", {});
  MomentAt observer(maker, 0.3);
  const auto scan = someScan();
  observer.onStep({0, scan, {}, {}});
  observer.onStep({0.2, scan, {}, {}});
  EXPECT_FALSE(observer.moment());
  EXPECT_THROW(observer.onStep({0.4, scan, {}, {}}), core::Interrupted);
  EXPECT_EQ(observer.moment()->time_s, 0.4);
  EXPECT_EQ(observer.moment()->scans, 3U);
}

}  // namespace
}  // namespace slam::live
