#include "libslam/movers/living.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/error.h"
#include "libslam/sim/simulator.h"
#include "tests/sim/two_rooms.h"

namespace slam::sim {
namespace {

using core::Pose2;

constexpr double kStart_s = Simulator::kStartTime_s;
const double kRobotRadius_m = robot::circumscribedRadius(robot::RobotOptions{});

movers::LivingOptions people(int count) {
  movers::LivingOptions options;
  options.people = count;
  return options;
}

/// The one door opens and closes; by turns of about a second.
movers::LivingOptions quickDoor() {
  movers::LivingOptions options;
  options.doors_share = 1;
  options.door_open_s = options.door_closed_s = 1;
  return options;
}

lidar::LidarOptions exactCircle(int beams) {
  lidar::LidarOptions options;
  options.fov_rad = 2 * core::kPi;
  options.beams = beams;
  options.min_range_m = options.max_range_m = options.sigma_m = 0;
  return options;
}

bool isClosed(const movers::Scene& scene) {
  return scene.doors()->all().front().state == movers::DoorState::kClosed;
}

std::vector<double> placesOf(const Simulator& simulator) {
  std::vector<double> places;
  for (const auto& person : simulator.scene().crowd()->people())
    places.insert(places.end(), {person.p.x, person.p.y});
  return places;
}

TEST(LivingWorld, IsOffByDefault) {
  const world::Plan plan = twoRooms();
  Simulator plain(plan, {}, exactCircle(40), {}, {3, 3, 0}, 1);
  EXPECT_FALSE(plain.scene().isAlive());
  EXPECT_EQ(plain.scene().crowd(), nullptr);
  EXPECT_EQ(plain.scene().doors(), nullptr);
  EXPECT_EQ(&plain.scene().plan(), &plan);
}

TEST(LivingWorld, IsTheSameHoweverTimeIsCutIntoCommands) {
  const world::Plan plan = twoRooms();
  movers::LivingOptions living = people(6);
  living.doors_share = 1;
  std::vector<std::vector<double>> ends;
  for (const double part_s : {12.0, 0.2, 0.025, 0.375, 0.016}) {
    Simulator simulator(plan, {}, exactCircle(4), {}, {2, 2, 0}, 5, kStart_s, living);
    for (int i = 0; i < std::lround(12 / part_s); ++i) simulator.step({0, 0.3, part_s});
    ends.push_back(placesOf(simulator));
  }
  for (const auto& end : ends) EXPECT_EQ(end, ends.front());
}

TEST(LivingWorld, SeesTheSameRobotHoweverItsDriveIsCut) {
  const world::Plan plan = twoRooms();
  std::vector<std::vector<double>> ends;
  std::vector<Pose2> robots;
  for (const double part_s : {4.0, 0.1}) {
    Simulator simulator(plan, {}, exactCircle(4), {}, {2, 2, 0.5}, 5, kStart_s, people(6));
    for (int i = 0; i < std::lround(4 / part_s); ++i) simulator.step({0.4, 0.2, part_s});
    ends.push_back(placesOf(simulator));
    robots.push_back(simulator.truth());
    EXPECT_TRUE(simulator.collisions().empty()) << "choose another seed";
  }
  // The arc composed of forty parts differs in the last digits, and people who walk round it spread that.
  EXPECT_NEAR(core::distance(robots[0], robots[1]), 0, 1e-12);
  for (size_t i = 0; i < ends[0].size(); ++i) EXPECT_NEAR(ends[0][i], ends[1][i], 1e-9);
}

TEST(LivingWorld, PeopleMoveNeitherTheTruthNorTheNoise) {
  const world::Plan plan = twoRooms();
  Simulator empty(plan, {}, exactCircle(90), {}, {2, 2, 0.5}, 5);
  Simulator crowded(plan, {}, exactCircle(90), {}, {2, 2, 0.5}, 5, kStart_s, people(6));
  for (int i = 0; i < 40; ++i) {
    const auto without = empty.step({0.3, 0.2, 0.1}), with = crowded.step({0.3, 0.2, 0.1});
    ASSERT_TRUE(crowded.collisions().empty()) << "choose another seed";
    EXPECT_EQ(empty.truth().x, crowded.truth().x);
    EXPECT_EQ(without.T_odom_robot.x, with.T_odom_robot.x);
    EXPECT_EQ(without.scan.time_s, with.scan.time_s);
    for (size_t k = 0; k < without.scan.ranges_m.size(); ++k)
      EXPECT_LE(with.scan.ranges_m[k], without.scan.ranges_m[k]);
  }
}

TEST(LivingWorld, TheScanIsTheNearerOfWallAndLeg) {
  const world::Plan plan = twoRooms();
  Simulator simulator(plan, {}, exactCircle(721), {}, {3, 3, 0.2}, 2, kStart_s, people(8));
  int on_legs = 0;
  for (int i = 0; i < 50; ++i) {
    const auto scan = simulator.step({0, 0, 0.1}).scan;
    std::vector<float> walls;
    movers::Scene(plan).castScan(simulator.truth(), {scan.first_angle_rad, scan.step_rad, 721}, 0, walls);
    for (size_t k = 0; k < walls.size(); ++k) {
      const double angle = simulator.truth().phi + scan.angle(k);
      double nearest = walls[k];
      for (const auto& body : simulator.scene().bodies())
        nearest = std::min(nearest, movers::castRay(body, {3, 3}, {std::cos(angle), std::sin(angle)}));
      ASSERT_EQ(scan.ranges_m[k], static_cast<float>(nearest));
      on_legs += scan.ranges_m[k] < walls[k];
    }
  }
  EXPECT_GT(on_legs, 500);
}

TEST(LivingWorld, APartOfASweepIsAScanOfFewerBeams) {
  const world::Plan plan = twoRooms();
  const movers::Scene scene(plan, people(8), 2, {{3, 3}, 0.3});
  std::vector<float> whole, part;
  scene.castScan({3, 3, 0.3}, {-2, 0.01, 400}, 5, whole);
  for (int i = 0; i < 400; i += 7) {
    scene.castScan({3, 3, 0.3}, {-2 + i * 0.01, 0.01, 1}, 5, part);
    ASSERT_EQ(part.front(), whole[static_cast<size_t>(i)]);
  }
}

TEST(LivingWorld, APersonInThePlansOwnFrameStandsWhereThePlanIsPlaced) {
  world::Plan plan = twoRooms();
  const movers::Scene straight(plan, people(3), 2, {{3, 3}, 0.3});
  plan.T_frame_raster = {10, -4, 1.1};
  const core::Point2 robot = plan.T_frame_raster * core::Point2{3, 3};
  const movers::Scene placed(plan, people(3), 2, {robot, 0.3});
  for (size_t i = 0; i < straight.bodies().size(); ++i) {
    const core::Point2 expected = plan.T_frame_raster * straight.bodies()[i].p;
    EXPECT_NEAR(core::distance(expected, placed.bodies()[i].p), 0, 1e-12);
    EXPECT_TRUE(placed.discCollides(placed.bodies()[i].p, 0));
  }
}

TEST(LivingWorld, DrivingIntoAPersonIsACollisionAndAPersonWhoComesNearIsNone) {
  world::Plan plan = twoRooms();
  for (int row = 50; row < 70; ++row)  // no doorway: the person stays in the robot's room
    plan.cells[static_cast<size_t>(row) * plan.columns + 120] = world::Cell::kOccupied;
  movers::LivingOptions living = people(1);
  living.pause_share = 1, living.pause_s = 1e5;
  Simulator simulator(plan, {}, exactCircle(4), {}, {2, 2, 0}, 9, kStart_s, living);
  for (int i = 0; i < 600; ++i) ASSERT_FALSE(simulator.step({0, 0.5, 0.1}).collided);
  const core::Point2 person = simulator.scene().crowd()->people()[0].p;
  const core::Point2 to = core::inverse(simulator.truth()) * person;
  simulator.step({0, std::atan2(to.y, to.x), 1});
  // Faster than anybody can set out: no robot does that, but a test may.
  const auto sensed = simulator.step({20, 0, 1});
  EXPECT_TRUE(sensed.collided);
  ASSERT_EQ(simulator.collisions().size(), 1U);
  const double gap_m = core::distance(core::position(simulator.truth()), person) - kRobotRadius_m - 0.25;
  // It was met where it stood within the first tick or a step later: half a metre is what 25 ms at 20 m/s
  // are.
  EXPECT_GE(gap_m, 0);
  EXPECT_LT(gap_m, 0.5);
}

TEST(LivingWorld, AClosedDoorStopsTheRayAndTheRobotAndAnOpenOneDoesNot) {
  const world::Plan plan = twoRooms();
  const Pose2 start{5, 3, 0};
  Simulator simulator(plan, {}, exactCircle(4), {}, start, 1, kStart_s, quickDoor());
  ASSERT_FALSE(isClosed(simulator.scene()));
  int closed = 0, open = 0;
  for (int i = 0; i < 200; ++i) {
    const auto scan = simulator.step({0, 0, 0.1}).scan;
    const double ahead_m = scan.ranges_m[2];
    // Ranges are floats of some metres. The door's near face is at x = 6, the far wall at x = 12.
    EXPECT_NEAR(ahead_m, isClosed(simulator.scene()) ? 1 : 7, 1e-5);
    EXPECT_EQ(simulator.scene().discCollides({6, 3}, 0.1), isClosed(simulator.scene()));
    (isClosed(simulator.scene()) ? closed : open) += 1;
  }
  // A mean of one second each way, one look in 0.1 s: neither state is rare in 20 s.
  EXPECT_GT(closed, 50);
  EXPECT_GT(open, 50);
  EXPECT_EQ(plan.at(121, 60), world::Cell::kFree);  // the caller's plan is its own
  EXPECT_EQ(simulator.scene().planWithDoorsOpen().at(121, 60), world::Cell::kFree);

  while (!isClosed(simulator.scene())) simulator.step({0, 0, 0.025});
  const auto sensed = simulator.step({1, 0, 0.9});
  if (isClosed(simulator.scene())) {
    EXPECT_TRUE(sensed.collided);
    EXPECT_LE(simulator.truth().x, 6 - kRobotRadius_m);
  }
}

TEST(LivingWorld, ADoorDoesNotCloseOnTheRobot) {
  const world::Plan plan = twoRooms();
  for (const double x : {6.0, 6.35}) {  // in the doorway, and with the rim in it
    Simulator simulator(plan, {}, exactCircle(4), {}, {x, 3, 0}, 1, kStart_s, quickDoor());
    for (int i = 0; i < 200; ++i) {
      simulator.step({0, 1, 0.1});
      ASSERT_FALSE(isClosed(simulator.scene()));
    }
    EXPECT_EQ(simulator.scene().doors()->all().front().state, movers::DoorState::kHeld);
    bool closed_behind_it = false;
    while (simulator.truth().x < 7) {
      const bool looks_ahead = std::cos(simulator.truth().phi) > 0.999;
      ASSERT_FALSE(simulator.step({looks_ahead ? 0.5 : 0.0, looks_ahead ? 0.0 : 0.5, 0.025}).collided);
      closed_behind_it |= isClosed(simulator.scene());
    }
    EXPECT_TRUE(closed_behind_it);
  }
}

TEST(LivingWorld, DoorsNeverCloseOnPeople) {
  const world::Plan plan = twoRooms();
  movers::LivingOptions living = quickDoor();
  living.people = 8;
  Simulator simulator(plan, {}, exactCircle(4), {}, {1, 1, 0}, 4, kStart_s, living);
  int closed = 0;
  for (int i = 0; i < 6000; ++i) {
    simulator.step({0, 0, 0.05});
    closed += isClosed(simulator.scene());
    for (const auto& person : simulator.scene().crowd()->people())
      ASSERT_FALSE(world::discCollides(simulator.scene().plan(), person.p, 0.25)) << "step " << i;
  }
  EXPECT_GT(closed, 500);
}

TEST(LivingWorld, OnlyTheShareOfDoorsMoves) {
  world::Plan plan = twoRooms();
  plan.doors.assign(400, plan.doors.front());
  for (const double share : {0.0, 0.25, 1.0}) {
    movers::LivingOptions options;
    options.doors_share = share;
    // 400 draws: a deviation of at most 0.022, four of them.
    EXPECT_NEAR(static_cast<double>(movers::Doors(plan, options, 1).all().size()) / 400, share, 0.088);
  }
}

TEST(LivingWorld, DoorsKeepTheirTimes) {
  const world::Plan plan = twoRooms();
  movers::LivingOptions options;
  options.doors_share = 1;
  options.door_open_s = 4, options.door_closed_s = 2;
  movers::Doors doors(plan, options, 1);
  std::vector<double> lengths;
  int last = 0;
  for (int tick = 1; lengths.size() < 401; ++tick)
    if (!doors.tick({}, 0).empty()) {
      lengths.push_back((tick - last) * 0.025);
      last = tick;
    }
  double open_s = 0, closed_s = 0;
  for (size_t i = 1; i < lengths.size(); i += 2) {  // the first had begun before
    closed_s += lengths[i], open_s += lengths[i + 1];
    EXPECT_GE(lengths[i], 1 - 0.025);
    EXPECT_LE(lengths[i], 3);
  }
  // Uniform within half of the mean: a deviation of 0.29 means of one, of 200 one of 0.0204 means; four of
  // them.
  EXPECT_NEAR(open_s / 200, 4, 4 * 4 * 0.0204);
  EXPECT_NEAR(closed_s / 200, 2, 4 * 2 * 0.0204);
}

TEST(LivingWorld, SaysWhenThereIsNoDoorToMove) {
  world::Plan plan = twoRooms();
  plan.doors.clear();
  try {
    const movers::Scene scene(plan, quickDoor(), 1, {});
    FAIL();
  } catch (const core::InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "plan 'two rooms': section [living], key 'doors_share': found 1, expected 0: the plan names no doors "
        "(key 'doors' of its yaml)");
  }
}

TEST(LivingWorld, SaysWhatIsWrongWithItsOptions) {
  files::IniFile ini;
  ini.set("living", "people", "-1", "run.ini:3");
  movers::LivingOptions options;
  try {
    files::readParameters(ini, movers::LivingOptions::table(), options);
    FAIL();
  } catch (const core::InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("run.ini:3"));
    EXPECT_THAT(error.what(), testing::HasSubstr("people"));
  }
}

}  // namespace
}  // namespace slam::sim
