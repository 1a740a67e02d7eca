#include "libslam/sim/carry.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "libslam/core/error.h"
#include "libslam/sim/simulator.h"
#include "libslam/testing/error_of.h"

namespace slam::sim {
namespace {
using ::testing::HasSubstr;

/// 10 x 6 m with walls one cell thick all round.
world::Plan room() {
  world::Plan plan;
  plan.name = "room";
  plan.columns = 200, plan.rows = 120;
  plan.cells.assign(24000, world::Cell::kFree);
  for (int row = 0; row < plan.rows; ++row)
    for (int column = 0; column < plan.columns; ++column)
      if (row == 0 || column == 0 || row == plan.rows - 1 || column == plan.columns - 1)
        plan.cells[static_cast<size_t>(row) * 200 + column] = world::Cell::kOccupied;
  return plan;
}

robot::OdometryOptions perfectOdometry() {
  robot::OdometryOptions options;
  options.alpha1 = options.alpha2 = options.alpha3 = options.alpha4 = 0;
  options.scale = 1;
  options.heading_bias_radpm = 0;
  return options;
}

class CarriedRobot : public ::testing::Test {
 protected:
  Simulator simulatorAt(const core::Pose2& start, const movers::LivingOptions& living = {}) const {
    return {plan_, {}, lidar::LidarOptions{}, perfectOdometry(), start, 3, 0, living};
  }
  world::Plan plan_ = room();
};

TEST(ParseCarries, ReadsTimesPlacesAndDegreesInAnyOrder) {
  const auto carries = parseCarries("60:12.5,3,90  5:1,-2,-180", "--carry");
  ASSERT_EQ(carries.size(), 2U);
  EXPECT_EQ(carries[0].time_s, 5);
  EXPECT_EQ(carries[0].T_world_robot.y, -2);
  EXPECT_EQ(carries[1].time_s, 60);
  EXPECT_EQ(carries[1].T_world_robot.x, 12.5);
  EXPECT_DOUBLE_EQ(carries[1].T_world_robot.phi, core::kPi / 2);
  EXPECT_TRUE(parseCarries("none", "--carry").empty());
}

TEST(ParseCarries, LeavesPlacesToChance) {
  const auto carries = parseCarries("60:random 70:visited 80:1,2,3", "--carry");
  ASSERT_EQ(carries.size(), 3U);
  EXPECT_EQ(carries[0].where, CarryOrder::Where::kRandom);
  EXPECT_EQ(carries[0].time_s, 60);
  EXPECT_EQ(carries[1].where, CarryOrder::Where::kVisited);
  EXPECT_EQ(carries[2].where, CarryOrder::Where::kGiven);
}

TEST_F(CarriedRobot, IsPutDownAnywhereThatItCanDriveTo) {
  // A wall with no way through: nobody carries it into the eastern part.
  for (int row = 0; row < plan_.rows; ++row)
    plan_.cells[static_cast<size_t>(row) * 200 + 120] = world::Cell::kOccupied;
  std::vector<core::Pose2> places;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Simulator simulator(plan_, {}, lidar::LidarOptions{}, perfectOdometry(), {1, 1, 0}, seed, 0);
    simulator.carryAt(parseCarries("1:random", "--carry"));
    for (int i = 0; i < 4; ++i) simulator.step({0.2, 0, 0.5});
    ASSERT_EQ(simulator.carries().size(), 1U);
    const core::Pose2& to = simulator.carries()[0].T_world_to;
    EXPECT_FALSE(world::discCollides(plan_, core::position(to), robot::circumscribedRadius({})));
    EXPECT_LT(to.x, 6);
    EXPECT_GE(core::distance(to, simulator.carries()[0].T_world_from), 3);
    places.push_back(to);
  }
  EXPECT_NE(places[0].x, places[1].x);
  const auto beyond = [](const core::Pose2& T) { return T.y > 3; };
  EXPECT_GT(std::count_if(places.begin(), places.end(), beyond), 5);
}

TEST_F(CarriedRobot, IsPutDownWhereItWas) {
  auto simulator = simulatorAt({1, 1, 0});
  simulator.carryAt(parseCarries("10:visited", "--carry"));
  std::vector<core::Point2> path;
  for (int i = 0; i < 21; ++i) {
    simulator.step({0.6, 0, 0.5});
    if (simulator.carries().empty()) path.push_back(core::position(simulator.truth()));
  }
  ASSERT_EQ(simulator.carries().size(), 1U);
  const core::Pose2& to = simulator.carries()[0].T_world_to;
  EXPECT_TRUE(std::any_of(path.begin(), path.end(), [&](const core::Point2& p) {
    return core::distance(p, core::position(to)) < 1e-9;
  }));
  EXPECT_GE(core::distance(to, simulator.carries()[0].T_world_from), 3);
}

TEST(ParseCarries, RefusesInOneLineThatNamesTheOrigin) {
  for (const std::string bad : {"60", "60:1,2", "60:1,2,3,4", "60:1,2,3,", "60:1,,3", "a:1,2,3", "60:1,2,nan",
                                "60:inf,2,3", ":1,2,3", "60 :1,2,3"})
    EXPECT_THAT(testing::errorOf([&bad] { parseCarries(bad, "--carry"); }),
                HasSubstr("expected TIME_S:X_M,Y_M,HEADING_DEG"))
        << bad;
  EXPECT_THAT(testing::errorOf([] { parseCarries("-1:1,2,3", "--carry"); }),
              HasSubstr("--carry: found '-1:1,2,3', expected a time above 0"));
  EXPECT_THAT(testing::errorOf([] { parseCarries("0:1,2,3", "--carry"); }), HasSubstr("above 0"));
  EXPECT_THAT(testing::errorOf([] { parseCarries("7:1,2,3 7:2,2,3", "--carry"); }),
              HasSubstr("two events at 7 s"));
  EXPECT_THAT(testing::errorOf([] { parseCarries(" ", "--carry"); }), HasSubstr("found nothing"));
  EXPECT_THAT(testing::errorOf([] { requireBefore(parseCarries("60:1,2,3", "--carry"), 60); }),
              HasSubstr("--carry: found an event at 60 s, expected one before the end at 60 s"));
}

TEST_F(CarriedRobot, TheTruthJumpsAndTheWheelsDoNotNotice) {
  auto simulator = simulatorAt({2, 3, 0});
  simulator.carryAt(parseCarries("2:7,2,90", "test"));
  const robot::Command ahead{0.5, 0, 1};
  simulator.step(ahead);
  EXPECT_NEAR(simulator.truth().x, 2.5, 1e-12);
  const auto carried = simulator.step(ahead);  // the moment is the end of this command
  EXPECT_EQ(simulator.truth().x, 7);
  EXPECT_NEAR(carried.T_odom_robot.x, 1.0, 1e-12);
  const auto after = simulator.step(ahead);
  EXPECT_NEAR(simulator.truth().x, 7, 1e-12);
  EXPECT_NEAR(simulator.truth().y, 2.5, 1e-12);
  EXPECT_NEAR(after.T_odom_robot.x, 1.5, 1e-12);
  EXPECT_EQ(after.T_odom_robot.y, 0);
  EXPECT_TRUE(simulator.collisions().empty());
  ASSERT_EQ(simulator.carries().size(), 1U);
  EXPECT_EQ(simulator.carries()[0].time_s, 2);
  EXPECT_NEAR(simulator.carries()[0].T_world_from.x, 3, 1e-12);
  EXPECT_EQ(simulator.carries()[0].T_world_to.x, 7);
}

TEST_F(CarriedRobot, AmidACommandTheRestIsDrivenFromTheNewPlace) {
  auto simulator = simulatorAt({2, 3, 0});
  simulator.carryAt(parseCarries("1.25:7,2,90", "test"));
  const auto sensed = simulator.step({0.5, 0, 4});
  EXPECT_NEAR(simulator.truth().x, 7, 1e-12);
  EXPECT_NEAR(simulator.truth().y, 2 + 0.5 * 2.75, 1e-9);
  EXPECT_NEAR(sensed.T_odom_robot.x, 2, 1e-12);
  EXPECT_EQ(simulator.time_s(), 4);
  EXPECT_NEAR(simulator.carries().at(0).T_world_from.x, 2 + 0.5 * 1.25, 1e-9);
}

TEST_F(CarriedRobot, ACollisionBeforeEndsTheCommandForGood) {
  auto simulator = simulatorAt({9, 3, 0});
  simulator.carryAt(parseCarries("3:5,3,0", "test"));
  const auto sensed = simulator.step({0.5, 0, 6});
  EXPECT_TRUE(sensed.collided);
  EXPECT_EQ(simulator.truth().x, 5);
  EXPECT_LT(sensed.T_odom_robot.x, 1);
  EXPECT_EQ(simulator.collisions().size(), 1U);
}

TEST_F(CarriedRobot, ACollisionAfterwardsCutsTheCommandThere) {
  auto simulator = simulatorAt({2, 3, 0});
  simulator.carryAt(parseCarries("2:9,3,0", "test"));
  const auto sensed = simulator.step({0.5, 0, 6});
  EXPECT_TRUE(sensed.collided);
  EXPECT_GT(simulator.truth().x, 9);
  EXPECT_LT(simulator.truth().x, 9.8);
  EXPECT_NEAR(sensed.T_odom_robot.x, 1 + simulator.truth().x - 9, 1e-9);
}

TEST_F(CarriedRobot, WithoutCarriesEveryBitIsAsItWas) {
  auto plain = simulatorAt({2, 3, 0}), later = simulatorAt({2, 3, 0});
  later.carryAt(parseCarries("1000:7,2,90", "test"));
  for (int i = 0; i < 20; ++i) {
    const auto a = plain.step({0.3, 0.2, 0.7}), b = later.step({0.3, 0.2, 0.7});
    EXPECT_EQ(a.scan.ranges_m, b.scan.ranges_m);
    EXPECT_EQ(a.T_odom_robot.x, b.T_odom_robot.x);
  }
  EXPECT_EQ(later.waitingCarries(), 1U);
}

TEST_F(CarriedRobot, NowIsBeforeTheNextCommand) {
  auto simulator = simulatorAt({2, 3, 0});
  simulator.carryNow({5, 2, 0});
  simulator.step({0.5, 0, 1});
  EXPECT_NEAR(simulator.truth().x, 5.5, 1e-12);
}

TEST_F(CarriedRobot, PlacesWithoutRoomAreRefused) {
  const auto refusal = [this](const std::string& place) {
    return testing::errorOf([&] { simulatorAt({2, 3, 0}).carryAt(parseCarries("5:" + place, "--carry")); });
  };
  EXPECT_THAT(refusal("0.02,3,0"),
              HasSubstr("--carry: the place at 5 s (0.020 m, 3.000 m, 0.0 deg) is in a wall"));
  EXPECT_THAT(refusal("20,3,0"), HasSubstr("is outside the plan"));
  EXPECT_THAT(refusal("0.2,3,0"), HasSubstr("is too near to a wall, expected a clearance of"));
  EXPECT_EQ(refusal("5,3,0"), "no error");
}

TEST_F(CarriedRobot, WaitsUntilNobodyStandsThere) {
  movers::LivingOptions living;
  living.people = 1;
  living.body = "disc";
  auto simulator = simulatorAt({1, 1, 0}, living);
  const auto person = simulator.scene().bodies().at(0).p;
  simulator.carryNow({person.x, person.y, 0});
  simulator.step({0, 0, 0.1});
  EXPECT_TRUE(simulator.carries().empty());
  EXPECT_EQ(simulator.waitingCarries(), 1U);
  for (int i = 0; i < 600 && simulator.carries().empty(); ++i) simulator.step({0, 0, 0.1});
  EXPECT_EQ(simulator.carries().size(), 1U);
}

TEST(DrivenPath, LeavesOutWhatTheRobotWasCarried) {
  DrivenPath path;
  std::vector<Carry> carries;
  path.add({0, 0, 0}, carries);
  path.add({1, 0, 0}, carries);
  carries.push_back({3, {1.5, 0, 0}, {10, 10, 0}});
  path.add({10, 10.25, 0}, carries);
  path.add({10, 11, 0}, carries);
  EXPECT_DOUBLE_EQ(path.length_m(), 1 + 0.5 + 0.25 + 0.75);
}

}  // namespace
}  // namespace slam::sim
