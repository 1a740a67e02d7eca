// What robots of a team hear of each other, and in whose frame.
#include "libslam/teams/team_radio.h"

#include <gtest/gtest.h>

#include "libslam/teams/team.h"

namespace slam::teams {
namespace {

using core::kPi;
using Raster = gridmap::OccupancyRaster;

RobotNews at(double time_s, const core::Pose2& T_map_robot, std::optional<core::Point2> goal = {}) {
  RobotNews news;
  news.time_s = time_s, news.T_map_robot = T_map_robot, news.goal = goal;
  return news;
}

// The second robot starts 2 m ahead of the first, and has turned left by a quarter: what is ahead of it is to
// the left of the first.
TEST(TeamRadio, PlacesAndGoalsAreInTheListenersFrame) {
  TeamRadio radio({{5, 7, kPi / 2}, {5, 9, kPi}}, 100);
  radio.listen({{5, 7}, {5, 9}});
  radio.tell(1, at(1, {1, 0, 0}, core::Point2{3, 1}));
  radio.tell(0, at(1, {0.5, 0, 0}));
  const auto of_first = radio.teamOf(0, 1), of_second = radio.teamOf(1, 1);
  ASSERT_EQ(of_first.size(), 1U);
  EXPECT_NEAR(of_first[0].p_map.x, 2, 1e-12);
  EXPECT_NEAR(of_first[0].p_map.y, 1, 1e-12);
  ASSERT_TRUE(of_first[0].goal);
  EXPECT_NEAR(of_first[0].goal->x, 1, 1e-12);
  EXPECT_NEAR(of_first[0].goal->y, 3, 1e-12);
  EXPECT_FALSE(of_first[0].goes_first);
  ASSERT_EQ(of_second.size(), 1U);
  // A metre and a half behind to its left: it looks along the first one's left.
  EXPECT_NEAR(of_second[0].p_map.x, 0, 1e-12);
  EXPECT_NEAR(of_second[0].p_map.y, 1.5, 1e-12);
  EXPECT_FALSE(of_second[0].goal);
  EXPECT_TRUE(of_second[0].goes_first) << "of two as near the one with the smaller number";
  const auto T = radio.frameOf(0, 1);
  EXPECT_NEAR(T.x, 2, 1e-12);
  EXPECT_NEAR(T.phi, kPi / 2, 1e-12);
}

TEST(TeamRadio, RangeIsADistanceAndZeroIsDeaf) {
  TeamRadio radio({{}, {}, {}}, 3);
  radio.listen({{0, 0}, {3, 0}, {3, 3.01}});
  EXPECT_TRUE(radio.hears(0, 1));
  EXPECT_TRUE(radio.hears(1, 0));
  EXPECT_FALSE(radio.hears(1, 2));
  EXPECT_FALSE(radio.hears(0, 2));
  TeamRadio deaf({{}, {}}, 0);
  deaf.listen({{1, 1}, {1, 1}});
  EXPECT_FALSE(deaf.hears(0, 1));
  EXPECT_TRUE(TeamRadio({{}}, 1).teamOf(0, 0).empty());
}

// A chain of robots is one group, in whatever order they stand; and it breaks as it was made.
TEST(TeamRadio, ChainsOfAnyOrderAreOneGroup) {
  TeamRadio radio({{}, {}, {}, {}}, 1);
  radio.listen({{0, 0}, {3, 0}, {1, 0}, {2, 0}});  // 0 - 2 - 3 - 1
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t b = 0; b < 4; ++b) EXPECT_TRUE(radio.hears(a, b)) << a << " " << b;
  radio.listen({{0, 0}, {3, 0}, {1, 0}, {2.5, 0}});
  EXPECT_TRUE(radio.hears(0, 2));
  EXPECT_TRUE(radio.hears(3, 1));
  EXPECT_FALSE(radio.hears(2, 3));
  EXPECT_FALSE(radio.hears(0, 1));
}

TEST(TeamRadio, NewsReachOnlyThoseWhoHearIt) {
  TeamRadio radio({{}, {}, {}}, 1);
  radio.listen({{0, 0}, {0.5, 0}, {9, 0}});
  radio.tell(0, at(5, {1, 2, 0}, core::Point2{4, 4}));
  EXPECT_EQ(radio.teamOf(1, 5).size(), 1U);
  EXPECT_TRUE(radio.teamOf(2, 5).empty()) << "never heard";
  // Apart, its goal is still known, and where it was; a new place is not.
  radio.listen({{5, 0}, {0.5, 0}, {9, 0}});
  radio.tell(0, at(6, {9, 9, 0}));
  const auto known = radio.teamOf(1, 6);
  ASSERT_EQ(known.size(), 1U);
  EXPECT_FALSE(known[0].is_heard);
  EXPECT_DOUBLE_EQ(known[0].p_map.y, 2);
  // One that has no goal and is out of hearing is nothing to heed.
  radio.listen({{0, 0}, {0.5, 0}, {9, 0}});
  radio.tell(0, at(7, {1, 2, 0}));
  radio.listen({{5, 0}, {0.5, 0}, {9, 0}});
  EXPECT_TRUE(radio.teamOf(1, 7).empty());
}

/// A row of four cells of a metre, from the map's origin on.
Raster rowOf(const std::vector<float>& occupancy) {
  Raster raster;
  raster.columns = 4, raster.rows = 1, raster.resolution_m = 1;
  raster.occupancy = occupancy;
  return raster;
}

TEST(TeamRadio, MapsAreAskedOfThoseInHearingAndPassedOn) {
  TeamRadio radio({{}, {}, {}, {}}, 1);
  const auto older = std::make_shared<const Raster>(rowOf({0, 0.5F, 0.5F, 0.5F})),
             newer = std::make_shared<const Raster>(rowOf({1, 0.5F, 0.5F, 0.5F}));
  std::vector<std::size_t> asked;
  const auto fetch = [&](std::size_t robot, double time_s, const std::shared_ptr<const Raster>& map) {
    asked.clear();
    radio.fetchMaps(robot, time_s, [&](std::size_t other) {
      asked.push_back(other);
      return map;
    });
  };
  const auto own = rowOf({0.5F, 0.5F, 0.5F, 0.5F});
  EXPECT_EQ(radio.mapOf(0, own).occupancy, own.occupancy) << "nothing is known of the others";
  radio.listen({{0, 0}, {9, 0}, {9.5, 0}, {20, 0}});
  fetch(1, 10, older);
  EXPECT_EQ(asked, std::vector<std::size_t>{2});
  // Robot 1 comes to robot 0, and tells what it has of robot 2.
  radio.listen({{0, 0}, {0.5, 0}, {9.5, 0}, {20, 0}});
  EXPECT_EQ(radio.mapOf(0, own).at(0, 0), 0.5F);
  fetch(0, 20, std::make_shared<const Raster>(own));
  EXPECT_EQ(asked, std::vector<std::size_t>{1});
  EXPECT_LT(radio.mapOf(0, own).at(0, 0), 0.4F) << "what robot 2 saw, by way of robot 1";
  // Robot 3 has a newer one of robot 2 and meets robot 0; what robot 1 still has is older and changes
  // nothing.
  radio.listen({{0, 0}, {50, 0}, {20.5, 0}, {20, 0}});
  fetch(3, 30, newer);
  radio.listen({{20, 0}, {50, 0}, {90, 0}, {20, 0}});
  fetch(0, 40, std::make_shared<const Raster>(own));
  EXPECT_GT(radio.mapOf(0, own).at(0, 0), 0.6F);
  radio.listen({{20, 0}, {20, 0}, {90, 0}, {70, 0}});
  fetch(0, 50, std::make_shared<const Raster>(own));
  EXPECT_GT(radio.mapOf(0, own).at(0, 0), 0.6F);
}

TEST(TeamRadio, MapsComeInTheListenersFrame) {
  TeamRadio radio({{0, 0, 0}, {2, 0, 0}}, 10);
  radio.listen({{0, 0}, {2, 0}});
  auto theirs = std::make_shared<const Raster>(rowOf({0, 1, 0.5F, 0.5F}));
  radio.fetchMaps(0, 1, [&](std::size_t) { return theirs; });
  const Raster filled = radio.mapOf(0, rowOf({0, 0, 0.5F, 0.5F}));
  // Their cells 0 and 1 are this one's cells 2 and 3; what it has itself stays.
  const auto value = [&](double x) { return filled.at(filled.columnOf(x), filled.rowOf(0.5)); };
  EXPECT_LT(value(0.5), 0.4F);
  EXPECT_LT(value(1.5), 0.4F);
  EXPECT_LT(value(2.5), 0.4F);
  EXPECT_GT(value(3.5), 0.6F);
}

}  // namespace
}  // namespace slam::teams
