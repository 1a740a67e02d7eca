#include "libslam/choices/passers.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/navigate/scenes.h"

namespace slam::choices {
namespace {

constexpr double kCell_m = 0.05, kPeriod_s = 0.2;

/// A hall of 6 x 4 m, as it is and as a map shows it.
world::Plan hall() {
  return navigate::scenes::room(6, 4);
}

/// With a leg of 0.1 m.
world::Plan hallWithLegAt(const core::Point2& p) {
  auto plan = hall();
  navigate::scenes::fill(plan, p.x - 0.05, p.y - 0.05, p.x + 0.05, p.y + 0.05);
  return plan;
}

/// Passers, and a robot that is told to stand, or to drive, and does.
struct Watch {
  Passers passers;
  double time_s = 0;
  core::Pose2 T_world_robot = {1, 2, 0};

  void see(const world::Plan& plan, const core::Pose2& T_world_map = {}) {
    passers.see(navigate::scenes::scanIn(plan, T_world_robot, time_s),
                core::between(T_world_map, T_world_robot), kCell_m);
    time_s += kPeriod_s;
  }
  void drive(const robot::Command& command) {
    passers.tell(command);
    T_world_robot = T_world_robot * robot::driveMotion(command);
  }
  /// Somebody crosses before the robot and leaves.
  void letSomebodyPass() {
    for (int i = 0; i < 5; ++i) see(hall());
    for (double y = 1; y < 3; y += 0.2) see(hallWithLegAt({3, y}));
    for (int i = 0; i < 15; ++i) see(hall());
  }
};

paths::FreeSpace mapOf(const world::Plan& plan) {
  navigate::scenes::PerfectMap map(plan);
  for (const core::Pose2& T : {core::Pose2{1, 2, 0}, {5, 2, 0}, {3, 0.3, 0}, {3, 3.7, 0}})
    map.insert(T, navigate::scenes::scanIn(plan, T, 0));
  return paths::readFreeSpace(map.raster());
}

size_t occupiedCells(const paths::FreeSpace& space) {
  return static_cast<size_t>(std::count(space.state.begin(), space.state.end(), paths::kOccupiedCell));
}

TEST(Passers, AreTakenOutOfTheMapOnceTheyAreSeenNoMore) {
  const core::Point2 where{3, 2};
  Watch watch;
  for (int i = 0; i < 5; ++i) watch.see(hall());
  EXPECT_FALSE(watch.passers.areAbout());
  for (int i = 0; i < 4; ++i) watch.see(hallWithLegAt(where));
  EXPECT_TRUE(watch.passers.areAbout());
  EXPECT_FALSE(watch.passers.bodies().empty());
  for (const auto& p : watch.passers.bodies()) EXPECT_LT(core::distance(p, where), 0.3);

  auto map = mapOf(hallWithLegAt(where));
  const auto walls = occupiedCells(mapOf(hall()));
  ASSERT_GT(occupiedCells(map), walls);
  watch.passers.takeOutOf(map);
  EXPECT_GT(occupiedCells(map), walls) << "still there";
  watch.see(hall());
  EXPECT_TRUE(watch.passers.bodies().empty());
  watch.passers.takeOutOf(map);
  EXPECT_EQ(occupiedCells(map), walls);
}

TEST(Passers, WhoStandStillWhereTheyCameAreKeptClearOf) {
  Watch watch;
  for (int i = 0; i < 5; ++i) watch.see(hall());
  for (int i = 0; i < 30; ++i) watch.see(hallWithLegAt({3, 2}));
  EXPECT_FALSE(watch.passers.bodies().empty());
}

TEST(Passers, AreNothingThatComesInSightBehindACorner) {
  auto plan = hall();
  navigate::scenes::fill(plan, 2, 0, 2.1, 2.5);      // hides
  navigate::scenes::fill(plan, 4, 1.4, 4.1, 1.5);    // a post
  navigate::scenes::fill(plan, 3.2, 0.6, 3.3, 0.7);  // another
  Watch watch;
  watch.T_world_robot = {1, 1, core::kPi / 2};
  for (int i = 0; i < 40; ++i) {
    watch.see(plan);
    watch.drive({0.3, 0, kPeriod_s});
  }
  EXPECT_FALSE(watch.passers.areAbout());
}

TEST(Passers, AreNoPostsThatAPoseMoves) {
  auto plan = hall();
  for (double x = 2; x < 6; x += 1) navigate::scenes::fill(plan, x, 1, x + 0.1, 1.1);
  for (const double slip_m : {0.05, 0.15, 0.5}) {
    Watch watch;
    for (int i = 0; i < 40; ++i) watch.see(plan, {0, i < 20 ? 0 : slip_m, 0});
    EXPECT_FALSE(watch.passers.areAbout()) << slip_m;
  }
}

TEST(Passers, AreNoLargerThanAPerson) {
  // A door that swings into what was looked through.
  auto door = hall();
  navigate::scenes::fill(door, 3, 1, 3.1, 2);
  Watch watch;
  for (int i = 0; i < 5; ++i) watch.see(hall());
  for (int i = 0; i < 10; ++i) watch.see(door);
  EXPECT_FALSE(watch.passers.areAbout());
}

TEST(Passers, AreSeenByARobotThatDrives) {
  Watch watch;
  watch.T_world_robot = {0.5, 2, 0};
  for (int i = 0; i < 20; ++i) {
    watch.see(i < 8 ? hall() : hallWithLegAt({4, 3 - 0.2 * (i - 8)}));
    watch.drive({0.3, 0.2, kPeriod_s});
  }
  EXPECT_TRUE(watch.passers.areAbout());
}

TEST(Passers, ThatNobodySawComeAreSuspectedAmongSmallThingsOnly) {
  auto plan = hallWithLegAt({2, 1});
  navigate::scenes::fill(plan, 4, 3, 4.8, 3.1);  // a cupboard
  const auto walls_and_cupboard = [] {
    auto without = hall();
    navigate::scenes::fill(without, 4, 3, 4.8, 3.1);
    return occupiedCells(mapOf(without));
  }();
  auto map = mapOf(plan);
  const auto all = occupiedCells(map);
  Watch watch;
  watch.passers.suspectSmallThings();
  watch.passers.takeOutOf(map);
  EXPECT_EQ(occupiedCells(map), all) << "nobody is about";
  watch.letSomebodyPass();
  watch.passers.takeOutOf(map);
  EXPECT_EQ(occupiedCells(map), walls_and_cupboard);
}

}  // namespace
}  // namespace slam::choices
