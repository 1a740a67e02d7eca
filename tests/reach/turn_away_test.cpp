#include "libslam/reach/turn_away.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "libslam/core/error.h"
#include "libslam/resources/file_hash.h"
#include "libslam/testing/temp_folder.h"

namespace slam::reach {
namespace {

TurnAwayConfig config(const std::vector<std::string>& settings = {}) {
  files::IniFile ini;
  for (const auto& setting : settings) ini.setFromArgument(setting, "test");
  return readTurnAwayConfig(ini);
}

double distanceToNearest(const core::Point2& p, const std::vector<core::Point2>& others) {
  double nearest = 1e9;
  for (const auto& other : others) nearest = std::min(nearest, core::distance(p, other));
  return nearest;
}

TEST(TurnAway, TheCamerasObstaclesLeaveTheViewForTheMemoryAtTheRightPlaces) {
  const auto moments = turnAway(config());
  ASSERT_EQ(moments.size(), 6U);
  EXPECT_EQ(moments[0].seen.size(), 7U);
  EXPECT_TRUE(moments[0].remembered.empty());
  size_t seen_before = 8;
  for (size_t i = 0; i < 4; ++i) {  // while it turns
    EXPECT_LT(moments[i].seen.size(), seen_before);
    seen_before = moments[i].seen.size();
  }
  EXPECT_TRUE(moments[3].seen.empty());
  EXPECT_EQ(moments[3].remembered.size(), 5U);  // two stood farther ahead than the zone is wide to a side
  EXPECT_EQ(moments[4].remembered.size(), 5U);
  EXPECT_GT(moments[5].seen.size(), 0U);
  EXPECT_GT(moments[5].remembered.size(), 0U);
  for (const auto& moment : moments)
    for (const auto* points : {&moment.seen, &moment.remembered})
      for (const auto& p : *points)
        EXPECT_LT(distanceToNearest(p, moment.posts), 1e-12);  // roundings of some forty ticks
}

TEST(TurnAway, TheLidarRemembersFacesOfPosts) {
  const auto moments = turnAway(config({"turn_away.sensor=lidar"}));
  EXPECT_GT(moments[0].seen.size(), 20U);
  EXPECT_TRUE(moments[3].seen.empty());
  EXPECT_GT(moments[3].remembered.size(), 5U);
  for (const auto& moment : moments)
    for (const auto* points : {&moment.seen, &moment.remembered})
      for (const auto& p : *points)  // ranges are floats of a few metres
        EXPECT_NEAR(distanceToNearest(p, moment.posts), kPostRadius_m, 1e-6);
}

TEST(TurnAway, TurningRightMirrorsTheSigns) {
  const auto left = turnAway(config()), right = turnAway(config({"turn_away.turn_deg=-90"}));
  for (const auto& p : left[3].remembered) EXPECT_LT(p.y, 0);
  for (const auto& p : right[3].remembered) EXPECT_GT(p.y, 0);
  EXPECT_FALSE(right[3].remembered.empty());
}

TEST(TurnAway, DrawsTheSameBytes) {
  const testing::TempFolder folder;
  for (const std::string sensor : {"camera", "lidar"}) {
    const auto c = config({"turn_away.sensor=" + sensor});
    drawTurnAway(turnAway(c), c, folder / "a.png");
    drawTurnAway(turnAway(c), c, folder / "b.png");
    EXPECT_EQ(resources::fileSha256(folder / "a.png"), resources::fileSha256(folder / "b.png"));
  }
}

}  // namespace
}  // namespace slam::reach
