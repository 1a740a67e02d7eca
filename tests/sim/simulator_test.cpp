#include "libslam/sim/simulator.h"

#include <gmock/gmock.h>

#include <cstring>

#include "libslam/core/error.h"
#include "libslam/resources/file_hash.h"

namespace slam::sim {
namespace {

using core::degToRad;
using core::Pose2;
using world::Cell;
using world::Plan;

/// width x height metres at 0.05 m, with walls one cell thick all round.
Plan room(double width_m, double height_m) {
  Plan plan;
  plan.name = "room";
  plan.columns = static_cast<int>(std::lround(width_m / plan.resolution_m));
  plan.rows = static_cast<int>(std::lround(height_m / plan.resolution_m));
  plan.cells.assign(static_cast<size_t>(plan.columns) * plan.rows, Cell::kFree);
  for (int row = 0; row < plan.rows; ++row)
    for (int column = 0; column < plan.columns; ++column)
      if (row == 0 || column == 0 || row == plan.rows - 1 || column == plan.columns - 1)
        plan.cells[static_cast<size_t>(row) * plan.columns + column] = Cell::kOccupied;
  return plan;
}

void occupy(Plan& plan, int column, int row) {
  plan.cells[static_cast<size_t>(row) * plan.columns + column] = Cell::kOccupied;
}

robot::OdometryOptions perfectOdometry() {
  robot::OdometryOptions options;
  options.alpha1 = options.alpha2 = options.alpha3 = options.alpha4 = 0;
  options.scale = 1;
  options.heading_bias_radpm = 0;
  return options;
}

lidar::LidarOptions circle(int beams, double sigma_m = 0) {
  lidar::LidarOptions options;
  options.fov_rad = 2 * core::kPi;
  options.beams = beams;
  options.min_range_m = 0;
  options.max_range_m = 0;
  options.sigma_m = sigma_m;
  return options;
}

/// Speeds and durations of every kind, forwards and backwards, arcs and turns in place.
std::vector<robot::Command> wanderingCommands(int count) {
  core::RandomStream random(7, "test commands");
  std::vector<robot::Command> commands;
  commands.reserve(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i)
    commands.push_back({random.chance(0.2) ? 0.0 : random.uniform(-0.5, 1.0), random.uniform(-1.0, 1.0),
                        random.uniform(0.0, 1.0)});
  return commands;
}

std::string errorOfStart(const Plan& plan, const Pose2& start) {
  try {
    const Simulator simulator(plan, {}, circle(4), {}, start, 1);
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Simulator, ComesBackToTheStartAfterASquare) {
  const Plan plan = room(5, 5);
  const robot::RobotOptions robot;
  const Pose2 start{1.5, 1.25, 0.3};
  Simulator simulator(plan, robot, circle(8), perfectOdometry(), start, 1);
  const auto first = simulator.sense();
  Sensed last;
  for (int side = 0; side < 4; ++side) {
    simulator.step(robot::moveCommand(robot, 1.3));
    last = simulator.step(robot::turnCommand(robot, degToRad(90)));
  }
  // Eight compositions of poses of order 1: a few ulps each.
  EXPECT_NEAR(core::distance(simulator.truth(), start), 0, 1e-14);
  EXPECT_NEAR(simulator.truth().phi, start.phi, 1e-14);
  EXPECT_NEAR(core::distance(last.T_odom_robot, {}), 0, 1e-14);
  for (size_t i = 0; i < first.scan.ranges_m.size(); ++i)
    EXPECT_FLOAT_EQ(last.scan.ranges_m[i], first.scan.ranges_m[i]);
  EXPECT_TRUE(simulator.collisions().empty());
}

TEST(Simulator, OdometryWithoutNoiseIsTheTruthSeenFromTheStart) {
  const Plan plan = room(6, 6);
  const Pose2 start{3, 3, 1};
  Simulator simulator(plan, {}, circle(4), perfectOdometry(), start, 1);
  for (const auto& command : wanderingCommands(300)) {
    const auto sensed = simulator.step(command);
    const Pose2 seen = core::between(start, simulator.truth());
    // Each step rounds a few times; 300 of them stay far below a nanometre. The cut of a collision is in
    // both.
    ASSERT_NEAR(core::distance(sensed.T_odom_robot, seen), 0, 1e-11);
  }
  EXPECT_FALSE(simulator.collisions().empty());
}

TEST(Simulator, SeesTheWallsOfARoomWhereGeometryPutsThem) {
  const Plan plan = room(6, 4);
  lidar::LidarOptions lidar = circle(72);
  lidar.mount_x_m = 0.1, lidar.mount_y_m = -0.05, lidar.mount_yaw_rad = 0.4;
  const Pose2 start{2.013, 1.507, 2.2};
  const auto scan = Simulator(plan, {}, lidar, {}, start, 1).sense().scan;
  const Pose2 T_world_lidar = start * Pose2{0.1, -0.05, 0.4};
  ASSERT_EQ(scan.ranges_m.size(), 72u);
  for (size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double angle = T_world_lidar.phi + scan.angle(i), c = std::cos(angle), s = std::sin(angle);
    const double to_x = ((c > 0 ? 5.95 : 0.05) - T_world_lidar.x) / c;
    const double to_y = ((s > 0 ? 3.95 : 0.05) - T_world_lidar.y) / s;
    EXPECT_NEAR(scan.ranges_m[i], std::min(to_x, to_y), 2e-6) << "beam " << i;  // ranges are floats
  }
}

TEST(Simulator, StopsWithinOneMillimetreOfAWallAndRecordsIt) {
  const Plan plan = room(5, 5);
  const robot::RobotOptions robot;
  const double contact_m = 4.95 - robot::circumscribedRadius(robot);
  Simulator simulator(plan, robot, circle(4), perfectOdometry(), {2.5, 2.5, 0}, 1, 1000.0);
  const auto sensed = simulator.step({0.5, 0, 10});

  EXPECT_TRUE(sensed.collided);
  EXPECT_LE(simulator.truth().x, contact_m);
  EXPECT_GE(simulator.truth().x, contact_m - 0.001);
  EXPECT_NEAR(sensed.T_odom_robot.x, simulator.truth().x - 2.5, 1e-12);  // the wheels stopped too
  EXPECT_EQ(simulator.time_s(), 1010.0);                                 // time still passes
  EXPECT_EQ(sensed.scan.time_s, 1010.0);
  ASSERT_EQ(simulator.collisions().size(), 1u);
  EXPECT_NEAR(simulator.collisions()[0].time_s, 1000 + (contact_m - 2.5) / 0.5, 0.001 / 0.5);
  EXPECT_EQ(simulator.collisions()[0].T_world_robot.x, simulator.truth().x);
}

TEST(Simulator, TurnsInPlaceAndBacksOffFromAWallThatItTouches) {
  const Plan plan = room(5, 5);
  Simulator simulator(plan, {}, circle(4), perfectOdometry(), {2.5, 2.5, 0}, 1);
  EXPECT_TRUE(simulator.step({0.5, 0, 10}).collided);
  EXPECT_TRUE(simulator.step({0.5, 0, 1}).collided);
  EXPECT_FALSE(simulator.step({0, 1, 7}).collided);
  EXPECT_FALSE(simulator.step({0, -1, 7}).collided);
  EXPECT_FALSE(simulator.step({-0.5, 0, 1}).collided);
  EXPECT_EQ(simulator.collisions().size(), 2u);
}

TEST(Simulator, StopsAtAPostThatOnlyTheRimOfTheDiscMeets) {
  Plan plan = room(5, 5);
  occupy(plan, 60, 54);  // its lower edge is 0.2 m left of the path y = 2.5
  const robot::RobotOptions robot;
  const double radius_m = robot::circumscribedRadius(robot);
  Simulator simulator(plan, robot, circle(4), {}, {1.5, 2.5, 0}, 1);
  EXPECT_TRUE(simulator.step({0.5, 0, 10}).collided);
  const double contact_m = 3.0 - std::sqrt(radius_m * radius_m - 0.2 * 0.2);
  EXPECT_LE(simulator.truth().x, contact_m);
  EXPECT_GE(simulator.truth().x, contact_m - 0.001);
}

TEST(Simulator, NeverPutsTheDiscIntoAWall) {
  Plan plan = room(4, 3);
  for (const auto& [column, row] : {std::pair{20, 15}, {40, 40}, {55, 22}, {60, 45}})
    occupy(plan, column, row);
  const robot::RobotOptions robot;
  Simulator simulator(plan, robot, circle(2), {}, {2, 1.5, 0}, 1);
  // Between two checks, 1 cm apart, a corner may enter by the sagitta 0.01^2 / (8 * 0.28) < 0.05 mm.
  const double radius_m = robot::circumscribedRadius(robot) - 0.0001;
  for (const auto& command : wanderingCommands(1000)) {
    simulator.step(command);
    ASSERT_FALSE(world::discCollides(plan, core::position(simulator.truth()), radius_m));
  }
  EXPECT_GT(simulator.collisions().size(), 50u);
}

TEST(Simulator, ItsClockDoesNotDrift) {
  const Plan plan = room(3, 3);
  Simulator simulator(plan, {}, circle(2), {}, {1.5, 1.5, 0}, 1, 5.0);
  for (int i = 0; i < 30000; ++i) simulator.step({0, 0, 0.1});  // adding up doubles would miss by 1e-8 s
  EXPECT_EQ(simulator.time_s(), 3005.0);
  simulator.step({0.1, 0, 0});
  EXPECT_EQ(simulator.time_s(), 3005.0);
}

/// Everything that leaves the simulator over 200 commands.
struct Recording {
  std::string truth, odometry, scans;
};

Recording record(const lidar::LidarOptions& lidar, const robot::OdometryOptions& odometry, std::uint64_t seed,
                 const Plan& plan = room(6, 4)) {
  const auto append = [](std::string& bytes, const Pose2& pose) {
    char raw[sizeof pose];
    std::memcpy(raw, &pose, sizeof pose);
    bytes.append(raw, sizeof raw);
  };
  Simulator simulator(plan, {}, lidar, odometry, {3, 2, 0.5}, seed);
  Recording recording;
  for (const auto& command : wanderingCommands(200)) {
    const auto sensed = simulator.step(command);
    append(recording.truth, simulator.truth());
    append(recording.odometry, sensed.T_odom_robot);
    recording.scans.append(reinterpret_cast<const char*>(sensed.scan.ranges_m.data()),
                           sensed.scan.ranges_m.size() * sizeof(float));
  }
  for (auto* bytes : {&recording.truth, &recording.odometry, &recording.scans})
    *bytes = resources::sha256(*bytes);
  return recording;
}

TEST(Simulator, TheSameSeedGivesTheSameBytes) {
  const auto once = record(circle(90, 0.02), {}, 5), again = record(circle(90, 0.02), {}, 5);
  EXPECT_EQ(once.truth, again.truth);
  EXPECT_EQ(once.odometry, again.odometry);
  EXPECT_EQ(once.scans, again.scans);
}

TEST(Simulator, TheSeedMovesTheNoiseAndNeverTheTruth) {
  const auto one = record(circle(90, 0.02), {}, 5), other = record(circle(90, 0.02), {}, 6);
  EXPECT_EQ(one.truth, other.truth);
  EXPECT_NE(one.odometry, other.odometry);
  EXPECT_NE(one.scans, other.scans);
}

TEST(Simulator, LidarAndOdometryNoiseDoNotTouchEachOther) {
  const auto plain = record(circle(90, 0.02), {}, 5);
  lidar::LidarOptions poor_lidar = circle(90, 0.1);
  poor_lidar.drop_out = 0.3;
  const auto poor_scans = record(poor_lidar, {}, 5);
  EXPECT_EQ(poor_scans.truth, plain.truth);
  EXPECT_EQ(poor_scans.odometry, plain.odometry);
  EXPECT_NE(poor_scans.scans, plain.scans);

  EXPECT_EQ(record(circle(45, 0.02), {}, 5).odometry, plain.odometry);  // fewer draws for the lidar

  const auto perfect = record(circle(90, 0.02), perfectOdometry(), 5);
  EXPECT_EQ(perfect.truth, plain.truth);
  EXPECT_EQ(perfect.scans, plain.scans);
  EXPECT_NE(perfect.odometry, plain.odometry);
}

/// A room with a pane, a mirror and a dark wall.
Plan roomOfMaterials() {
  Plan plan = room(6, 4);
  plan.materials.assign(plan.cells.size(), world::Material::kPlain);
  const auto make = [&](int column, int row, world::Material material) {
    occupy(plan, column, row);
    plan.materials[static_cast<size_t>(row) * plan.columns + column] = material;
  };
  for (int row = 5; row < 70; ++row) {
    make(100, row, world::Material::kGlass);
    make(0, row, world::Material::kMirror);
    make(119, row, world::Material::kDark);
  }
  return plan;
}

lidar::LidarOptions everyLidarError() {
  lidar::LidarOptions options = circle(90, 0.01);
  options.max_range_m = 12, options.min_range_m = 0.1, options.drop_out = 0.05;
  options.sigma_share = 0.01, options.quantum_m = 0.001;
  options.beam_width_rad = degToRad(0.8), options.mixed_pixels = 0.5;
  options.sweep = 0.9, options.sweep_clockwise = true, options.latency_s = 0.05;
  options.mount_error_x_m = 0.02, options.mount_error_y_m = -0.01, options.mount_error_yaw_rad = 0.01;
  options.dark_range_m = 3;
  return options;
}

robot::OdometryOptions everyOdometryError() {
  robot::OdometryOptions options;
  options.wheel_base_error = 0.03, options.wheel_radius_left_error = 0.01;
  options.slips_per_m = 1, options.tick_m = 0.002;
  options.gyro = true, options.gyro_bias_radps = 1e-3, options.gyro_bias_walk_radps = 1e-4;
  options.gyro_noise_radps = 1e-3;
  return options;
}

// As the golden bytes of recordings: a change says why.
TEST(Simulator, HasGoldenBytesWithEveryErrorOn) {
  const auto all = record(everyLidarError(), everyOdometryError(), 5, roomOfMaterials());
  EXPECT_EQ(all.odometry, "adca2014244658715a2b8426f48f405a92871f9fe9a54fc97dc5051123a08af1");
  EXPECT_EQ(all.scans, "96bab84ef524a5e78537c37cec8d686dad26765a0ca3db2c82880b4103be4b1f");
  const auto again = record(everyLidarError(), everyOdometryError(), 5, roomOfMaterials());
  EXPECT_EQ(again.scans, all.scans);
  EXPECT_EQ(again.odometry, all.odometry);
}

TEST(Simulator, NoErrorOfASensorMovesTheTruthOrTheOtherSensor) {
  const auto plain = record(circle(90, 0.02), {}, 5, roomOfMaterials());
  const auto poor_lidar = record(everyLidarError(), {}, 5, roomOfMaterials());
  EXPECT_EQ(poor_lidar.truth, plain.truth);
  EXPECT_EQ(poor_lidar.odometry, plain.odometry);
  EXPECT_NE(poor_lidar.scans, plain.scans);
  const auto poor_odometry = record(circle(90, 0.02), everyOdometryError(), 5, roomOfMaterials());
  EXPECT_EQ(poor_odometry.truth, plain.truth);
  EXPECT_NE(poor_odometry.odometry, plain.odometry);
  EXPECT_EQ(poor_odometry.scans, plain.scans);
}

TEST(Simulator, ALidarWithoutLimitReportsThePlansDiagonalAsItsMaximumRange) {
  Plan plan = room(4, 3);
  occupy(plan, 40, 30);
  for (int row = 20; row < 40; ++row) plan.cells[static_cast<size_t>(row) * plan.columns] = Cell::kFree;
  Simulator simulator(plan, {}, circle(4), {}, {1, 1.51, 0}, 1);
  const auto scan = simulator.sense().scan;
  EXPECT_DOUBLE_EQ(scan.max_range_m, 5.0);
  EXPECT_EQ(scan.ranges_m[0], lidar::kNoReturn);  // straight back, through the gap
  EXPECT_NEAR(scan.ranges_m[2], 1.0, 1e-6);       // straight ahead, the post at x = 2; ranges are floats
}

TEST(Simulator, RefusesAStartThatIsNotFree) {
  Plan plan = room(5, 4);
  EXPECT_EQ(errorOfStart(plan, {2, 2, 0}), "no error");
  EXPECT_EQ(errorOfStart(plan, {0.02, 2, 0}),
            "plan 'room': start pose (0.020 m, 2.000 m, 0.0 deg) is in a wall, expected a clearance of "
            "0.283 m all round");
  EXPECT_EQ(errorOfStart(plan, {-1, 2, 0}),
            "plan 'room': start pose (-1.000 m, 2.000 m, 0.0 deg) is outside the plan, expected a clearance "
            "of 0.283 m all round");
  EXPECT_EQ(errorOfStart(plan, {2, 0.3, degToRad(90)}),
            "plan 'room': start pose (2.000 m, 0.300 m, 90.0 deg) is too near to a wall, expected a "
            "clearance of 0.283 m all round");
  EXPECT_THAT(errorOfStart(plan, {std::nan(""), 2, 0}), testing::HasSubstr("is not finite"));
  EXPECT_THAT(errorOfStart(plan, {1e300, 2, 0}), testing::HasSubstr("is outside the plan"));
}

TEST(Simulator, RefusesCommandsThatMeanNothing) {
  const Plan plan = room(3, 3);
  Simulator simulator(plan, {}, circle(4), {}, {1.5, 1.5, 0}, 1);
  EXPECT_THROW(simulator.step({std::nan(""), 0, 1}), core::ContractError);
  EXPECT_THROW(simulator.step({0, INFINITY, 1}), core::ContractError);
  EXPECT_THROW(simulator.step({0, 0, -0.1}), core::ContractError);
  EXPECT_EQ(core::distance(simulator.truth(), {1.5, 1.5, 0}), 0);
}

}  // namespace
}  // namespace slam::sim
