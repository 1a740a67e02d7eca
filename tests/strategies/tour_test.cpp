#include "libslam/strategies/tour.h"

#include <gmock/gmock.h>

#include <cmath>

#include "libslam/buildings/building.h"
#include "libslam/choices/tour_stops.h"
#include "tests/navigate/scenes.h"
#include "tests/paths/drawn_map.h"

namespace slam::strategies {
namespace {

std::unique_ptr<Strategy> tour() {
  StrategyOptions options;
  options.name = "tour";
  return makeStrategy(options, {1, "strategy"});
}

/// The geometry is all that a map strategy takes from a scan.
lidar::Scan scanOf(double fov_deg) {
  lidar::Scan scan;
  scan.first_angle_rad = -core::degToRad(fov_deg / 2);
  scan.step_rad = core::degToRad(1);
  scan.max_range_m = 10;
  scan.ranges_m.assign(static_cast<std::size_t>(fov_deg), 3.0F);
  return scan;
}

gridmap::OccupancyRaster drawn(const std::vector<std::string>& lines) {
  return paths::enlarged(lines, 8, 0.05);  // 0.4 m a character
}

// A doorless niche near on the left, an open end far on the right.
const std::vector<std::string> kNicheAndOpenEnd = {"##########################",  //
                                                   "#???######################",  //
                                                   "#???######################",  //
                                                   "#.........................",  //
                                                   "#........................?",  //
                                                   "#........................?",  //
                                                   "##########################"};

TEST(Tour, TakesAPocketThatIsNearBeforeTheFarEnd) {
  const auto strategy = tour();
  strategy->seeMap(drawn(kNicheAndOpenEnd));
  const auto decision = strategy->decide(scanOf(360), {3.0, 0.9, 0});
  ASSERT_FALSE(decision.path.empty()) << decision.reason;
  EXPECT_LT(decision.goal.x, 3.0) << decision.reason;
  EXPECT_THAT(decision.reason, testing::StartsWith("first of 2 stops"));
}

TEST(Tour, ThatIsUnderWayDoesNotTurnBackForLess) {
  // Between two ends alike: where it aims, it goes on, though the other end is a little nearer by now.
  const auto map = drawn({"####################", "?..................?", "?..................?",
                          "?..................?", "####################"});
  const auto strategy = tour();
  strategy->seeMap(map);
  const auto first = strategy->decide(scanOf(360), {4.4, 1.0, 0});
  EXPECT_GT(first.goal.x, 4.4);
  const core::Pose2 later{3.9, 1.0, core::kPi / 2};
  EXPECT_GT(strategy->decide(scanOf(360), later).goal.x, 4.4);
  const auto fresh = tour();
  fresh->seeMap(map);
  EXPECT_LT(fresh->decide(scanOf(360), later).goal.x, 3.9);
}

TEST(Tour, CountsTheTurnAsAWay) {
  const auto map = drawn({"####################", "?..................?", "?..................?",
                          "?..................?", "####################"});
  for (const double heading_rad : {0.0, core::kPi}) {
    const auto strategy = tour();
    strategy->seeMap(map);
    const auto decision = strategy->decide(scanOf(360), {4.0, 1.0, heading_rad});
    EXPECT_EQ(decision.goal.x > 4.0, heading_rad == 0.0) << decision.reason;
  }
}

TEST(Tour, PlansAnewWhenTheMapHasGrown) {
  const auto strategy = tour();
  strategy->seeMap(drawn(kNicheAndOpenEnd));
  const core::Pose2 pose{3.0, 0.9, 0};
  const auto decision = strategy->decide(scanOf(360), pose);
  EXPECT_TRUE(strategy->isStillGood(decision, pose, 0));
  auto grown = kNicheAndOpenEnd;
  for (std::size_t row : {3U, 4U, 5U}) grown[row] += ".?";
  for (std::size_t row : {0U, 1U, 2U, 6U}) grown[row] += "##";
  grown[4].replace(25, 1, "."), grown[5].replace(25, 1, ".");  // 5 x 0.16 m2 of news, far from the goal
  strategy->seeMap(drawn(grown));
  EXPECT_FALSE(strategy->isStillGood(decision, pose, 0));
}

TEST(Tour, DropsAStopThatHasBeenSeenOnTheWay) {
  auto map = kNicheAndOpenEnd;
  const auto strategy = tour();
  strategy->seeMap(drawn(map));
  const core::Pose2 pose{3.0, 0.9, 0};
  const auto decision = strategy->decide(scanOf(360), pose);
  map[2] = "#...######################";  // the niche ends here
  map[1] = "##########################";
  strategy->seeMap(drawn(map));
  EXPECT_FALSE(strategy->isStillGood(decision, pose, 0));
  EXPECT_GT(strategy->decide(scanOf(360), pose).goal.x, 3.0);
}

TEST(Tour, EndsWhenWhatIsLeftCannotBeReached) {
  const auto strategy = tour();
  const auto map = drawn({"##########", "#....#...?", "#....#...?", "#....#...?", "##########"});
  strategy->seeMap(map);
  const auto decision = strategy->decide(scanOf(360), {1, 1, 0});
  EXPECT_TRUE(decision.finished);
  EXPECT_THAT(decision.reason, testing::HasSubstr("out of reach 1, given up after a look 0"));
}

TEST(Tour, TriesAGoalThatCannotBeReachedTwiceAndEnds) {
  const auto strategy = tour();
  const auto map = drawn({"#######", "?.....#", "?.....#", "#######"});
  int decisions = 0;
  for (; decisions < 20; ++decisions) {
    strategy->seeMap(map);
    const auto decision = strategy->decide(scanOf(360), {1.4, 0.8, 0});
    if (decision.finished) break;
    strategy->tellOutcome(decision, false);
  }
  EXPECT_LE(decisions, 4);
}

TEST(Openings, NarrowOnesLeadIntoNoRoom) {
  const auto space = paths::readFreeSpace(drawn(
      {"????????????", "????????????", "#.#######..#", "#..........#", "#..........#", "############"}));
  const auto frontiers = paths::findFrontiers(space, 1);
  ASSERT_EQ(frontiers.size(), 2u);  // 0.4 m and 0.8 m wide
  choices::Openings openings(space, frontiers, 0.6, 3);
  EXPECT_NEAR(openings.depth_m(frontiers[0].cells[0]), 0.2, 1e-6);
  EXPECT_NEAR(openings.depth_m(frontiers[1].cells[0]), 3, 1e-6);
  EXPECT_EQ(openings.depth_m(0), 3);
  const auto before_niche = choices::lookAround(space, openings, {0.6, 0.8}, 10);
  const auto before_door = choices::lookAround(space, openings, {4.0, 0.8}, 10);
  EXPECT_GT(before_door.area_m2, 5 * before_niche.area_m2);
  for (const auto& frontier : frontiers)
    for (const std::size_t cell : frontier.cells) openings.shut(cell);
  EXPECT_EQ(choices::lookAround(space, openings, {4.0, 0.8}, 10).area_m2, 0);
}

TEST(CoveringLooks, TakeTheLargestAndLeaveOutWhatItShows) {
  const auto look = [](std::size_t place, std::vector<std::pair<std::size_t, float>> cells) {
    choices::Look made;
    made.place = place;
    made.cells = std::move(cells);
    for (const auto& cell : made.cells) made.area_m2 += static_cast<double>(cell.second);
    return made;
  };
  const std::vector<choices::Look> looks = {look(0, {{1, 1}, {2, 1}}), look(1, {{1, 1}, {2, 1}, {3, 1}}),
                                            look(2, {{3, 1}, {4, 1}}), look(3, {{5, 0.05F}})};
  const auto cover = choices::coveringLooks(looks, 10, 0.1, 9);
  ASSERT_EQ(cover.size(), 2u);
  EXPECT_EQ(cover[0].place, 1u);
  EXPECT_EQ(cover[1].place, 2u);
  EXPECT_NEAR(cover[1].area_m2, 1, 1e-6);
  EXPECT_EQ(choices::coveringLooks(looks, 10, 0.1, 1).size(), 1u);
  EXPECT_TRUE(choices::coveringLooks({}, 10, 0.1, 1).empty());
}

}  // namespace
}  // namespace slam::strategies
