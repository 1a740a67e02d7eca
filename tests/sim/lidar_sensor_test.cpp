#include "libslam/sim/lidar_sensor.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "libslam/lidar/beam.h"
#include "libslam/rays/ray_caster.h"
#include "libslam/sim/simulator.h"
#include "tests/world/drawn_plan.h"

namespace slam::sim {
namespace {

using core::degToRad;
using core::kPi;
using core::Pose2;
using world::drawnPlan;
using world::Plan;

/// Bounds are five standard errors of the estimator: by chance a right program fails once in a million.
constexpr double kSigmas = 5;
/// Ranges are floats: half an ulp of a range up to 16 m is 5e-7, and a way of several rays adds some.
constexpr double kFloat_m = 3e-6;

lidar::LidarOptions circle(int beams) {
  lidar::LidarOptions options;
  options.fov_rad = 2 * kPi;
  options.beams = beams;
  options.min_range_m = options.max_range_m = options.sigma_m = 0;
  return options;
}

/// Few beams about straight ahead.
lidar::LidarOptions ahead(double fov_rad = degToRad(2), int beams = 3) {
  lidar::LidarOptions options = circle(beams);
  options.fov_rad = fov_rad;
  return options;
}

lidar::Scan look(const Plan& plan, const lidar::LidarOptions& options, const Pose2& T_world_robot,
                 std::uint64_t seed = 1) {
  const movers::Scene scene(plan);
  return LidarSensor(options, seed).sense(scene, T_world_robot, RecentPath(0), 100);
}

/// The middle of three beams.
float lookAhead(const Plan& plan, const lidar::LidarOptions& options, const Pose2& pose) {
  return look(plan, options, pose).ranges_m[1];
}

/// Shares of what one beam straight ahead reads in many scans.
std::map<float, double> sharesAhead(const Plan& plan, const lidar::LidarOptions& options, const Pose2& pose,
                                    int scans) {
  const movers::Scene scene(plan);
  LidarSensor sensor(options, 1);
  std::map<float, double> shares;
  for (int i = 0; i < scans; ++i)
    shares[sensor.sense(scene, pose, RecentPath(0), 0).ranges_m[1]] += 1.0 / scans;
  return shares;
}

double binomialError(double share, int count) {
  return std::sqrt(share * (1 - share) / count);
}

Plan room(int columns, int rows) {
  std::vector<std::string> lines(static_cast<size_t>(rows), "#" + std::string(columns - 2, '.') + "#");
  lines.front() = lines.back() = std::string(columns, '#');
  return drawnPlan(lines);
}

// ---- Everything off

TEST(LidarSensor, WithEverythingOffCastsOnceAndAddsTheOlderErrors) {
  const Plan plan = room(12, 9);
  lidar::LidarOptions options = circle(90);
  options.sigma_m = 0.02, options.drop_out = 0.1, options.mount_x_m = 0.2, options.mount_yaw_rad = 0.3;
  const Pose2 pose{4.3, 3.7, 1.1};
  const movers::Scene scene(plan);
  std::vector<float> expected_m;
  scene.castScan(pose * Pose2{0.2, 0, 0.3}, {-kPi, 2 * kPi / 90, 90}, 0, expected_m);
  core::RandomStream random(1, "lidar");
  lidar::applyLidarErrors(options, random, expected_m);
  const auto found_m = look(plan, options, pose).ranges_m;
  ASSERT_EQ(found_m.size(), 90U);
  int lost = 0;
  for (size_t i = 0; i < 90; ++i) {
    const bool is_lost = std::isnan(expected_m[i]);
    lost += is_lost;
    EXPECT_TRUE(is_lost ? std::isnan(found_m[i]) : found_m[i] == expected_m[i]) << i;
  }
  EXPECT_GT(lost, 0);
}

TEST(LidarSensor, ConsumersOfChanceDoNotTouchEachOther) {
  // Mixed pixels and glass draw from streams of their own: the noise of every other reading stays.
  const Plan plan = drawnPlan({"##########", "#........#", "#...GG...#", "#........#", "##########"});
  lidar::LidarOptions plain = circle(120), mixing = plain;
  plain.sigma_m = mixing.sigma_m = 0.05;
  plain.beam_width_rad = mixing.beam_width_rad = degToRad(0.5);
  mixing.mixed_pixels = 1;
  const auto a = look(plan, plain, {2.5, 3.2, 0}).ranges_m, b = look(plan, mixing, {2.5, 3.2, 0}).ranges_m;
  int same = 0;
  for (size_t i = 0; i < a.size(); ++i) same += a[i] == b[i];
  EXPECT_GT(same, 90);
  EXPECT_LT(same, 120);
}

// ---- Mounting

TEST(LidarSensor, StatesTheMountingPoseAndSensesFromTheTrueOne) {
  const Plan plan = room(12, 9);
  lidar::LidarOptions stated = circle(36), truly = circle(36);
  stated.mount_x_m = 0.1;
  stated.mount_error_x_m = 0.05, stated.mount_error_y_m = -0.02, stated.mount_error_yaw_rad = 0.1;
  truly.mount_x_m = 0.15, truly.mount_y_m = -0.02, truly.mount_yaw_rad = 0.1;
  const auto scan = look(plan, stated, {5, 4, 0.2});
  EXPECT_EQ(scan.T_robot_lidar.x, 0.1);
  EXPECT_EQ(scan.T_robot_lidar.phi, 0);
  EXPECT_EQ(scan.ranges_m, look(plan, truly, {5, 4, 0.2}).ranges_m);
}

// ---- Sweep and latency

struct Drive {
  lidar::Scan scan;
  Pose2 T_world_start, T_world_end;
};

/// One second of `command` in a wide room and the scan after it.
Drive drive(const lidar::LidarOptions& options, const robot::Command& command) {
  const Plan plan = room(40, 40);
  const Pose2 start{20, 20, 0.3};
  Simulator simulator(plan, {}, options, {}, start, 1);
  const auto scan = simulator.step(command).scan;
  return {scan, start, simulator.truth()};
}

TEST(Sweep, SensesEveryBeamFromWhereTheRobotThenWas) {
  lidar::LidarOptions options = circle(40);
  options.rate_hz = 1, options.sweep = 1;
  const Plan plan = room(40, 40);
  for (const bool clockwise : {false, true}) {
    options.sweep_clockwise = clockwise;
    const robot::Command command{2, 1.5, 1};
    const auto [scan, start, end] = drive(options, command);
    for (size_t i = 0; i < scan.ranges_m.size(); ++i) {
      const size_t order = clockwise ? 39 - i : i;
      const double time_s = static_cast<double>(order + 1) / 40;
      const Pose2 then = start * robot::driveMotion(command, time_s);
      EXPECT_NEAR(scan.ranges_m[i], rays::castRay(plan, core::position(then), then.phi + scan.angle(i), 0),
                  kFloat_m)
          << i;
    }
  }
}

TEST(Sweep, OfARobotThatStandsIsAsAtOnce) {
  lidar::LidarOptions swept = circle(40);
  swept.sweep = 1;
  EXPECT_EQ(drive(swept, {0, 0, 1}).scan.ranges_m, drive(circle(40), {0, 0, 1}).scan.ranges_m);
}

TEST(Sweep, CoversOnlyItsShareOfThePeriod) {
  // Turning at 1 rad/s for 1 s: the first beam of a sweep of 0.25 / rate is measured 0.25 s * (n-1)/n ago.
  lidar::LidarOptions options = circle(40);
  options.rate_hz = 1, options.sweep = 0.25;
  const auto [scan, start, end] = drive(options, {0, 1, 1});
  const double ago_s = 0.25 * 39 / 40;
  EXPECT_NEAR(scan.ranges_m[0], rays::castRay(room(40, 40), core::position(end), end.phi - kPi - ago_s, 0),
              kFloat_m);
}

TEST(Latency, ShowsThePlaceOfThatLongAgo) {
  lidar::LidarOptions options = circle(40);
  options.latency_s = 0.4;
  const robot::Command command{2, 0.5, 1};
  const auto [scan, start, end] = drive(options, command);
  const auto then = look(room(40, 40), circle(40), start * robot::driveMotion(command, 0.6));
  for (size_t i = 0; i < 40; ++i) EXPECT_NEAR(scan.ranges_m[i], then.ranges_m[i], kFloat_m);
  EXPECT_EQ(scan.time_s, drive(circle(40), command).scan.time_s);  // stamped when it came
}

TEST(Latency, OfLongerThanTheDriveShowsTheStart) {
  lidar::LidarOptions options = circle(40);
  options.latency_s = 5;
  const auto [scan, start, end] = drive(options, {2, 0.5, 1});
  EXPECT_EQ(scan.ranges_m, look(room(40, 40), circle(40), start).ranges_m);
}

// ---- Width

TEST(BeamWidth, MakesAPostWiderByTheWidthOfTheBeam) {
  Plan plan = room(40, 11);
  plan.cells[5 * 40 + 20] = world::Cell::kOccupied;  // the near face is at x = 20
  lidar::LidarOptions thin = ahead(degToRad(20), 801), wide = thin;
  wide.beam_width_rad = degToRad(1);
  const auto seen_deg = [&](const lidar::LidarOptions& options) {
    const auto ranges_m = look(plan, options, {5, 5.5, 0}).ranges_m;
    const auto hits = std::count_if(ranges_m.begin(), ranges_m.end(), [](float r) { return r < 16; });
    return static_cast<double>(hits) * core::radToDeg(lidar::beamStep(options));
  };
  const double step_deg = 20.0 / 800;
  EXPECT_NEAR(seen_deg(thin), core::radToDeg(2 * std::atan(0.5 / 15)), 2 * step_deg);
  EXPECT_NEAR(seen_deg(wide) - seen_deg(thin), 1, 2 * step_deg);
}

TEST(BeamWidth, HardlyChangesAFlatWall) {
  lidar::LidarOptions wide = ahead();
  wide.beam_width_rad = degToRad(0.6);
  // The mean of r / cos over five rays up to 0.3 deg: r (1 + 0.5 * mean square), 10 m * 6.9e-6.
  EXPECT_NEAR(lookAhead(room(20, 11), wide, {9, 5.5, 0}), 10 * (1 + 0.5 * std::pow(degToRad(0.3), 2) / 2),
              kFloat_m);
}

TEST(MixedPixels, AreTheStatedShareAndUniformBetweenBothSides) {
  Plan plan = room(40, 11);
  for (int row = 0; row < 5; ++row) plan.cells[static_cast<size_t>(row) * 40 + 20] = world::Cell::kOccupied;
  // Straight ahead along the edge of that wall: two rays of five on it at 10 m, the rest at 29 m.
  lidar::LidarOptions options = ahead();
  options.beam_width_rad = degToRad(1), options.mixed_pixels = 0.3;
  const movers::Scene scene(plan);
  LidarSensor sensor(options, 1);
  const int scans = 4000;
  int mixed = 0;
  double sum_m = 0;
  for (int i = 0; i < scans; ++i) {
    const double range_m = sensor.sense(scene, {10, 5.0001, 0}, RecentPath(0), 0).ranges_m[1];
    EXPECT_GT(range_m, 9.999);
    EXPECT_LT(range_m, 29.01);
    if (range_m < 10.01) continue;  // 0.05 % of the mixtures are that near too
    ++mixed;
    sum_m += range_m;
  }
  EXPECT_NEAR(static_cast<double>(mixed) / scans, 0.3, kSigmas * binomialError(0.3, scans) + 0.3 * 0.0005);
  // A uniform over 19 m has the standard deviation 19 / sqrt(12).
  EXPECT_NEAR(sum_m / mixed, 19.5, kSigmas * 19 / std::sqrt(12.0 * mixed) + 0.005);
}

// ---- Materials

TEST(DarkSurfaces, AnswerUpToTheirRange) {
  const Plan plan = drawnPlan({"............", "...........D", "............"});
  lidar::LidarOptions options = ahead();
  options.dark_range_m = 5;
  EXPECT_NEAR(lookAhead(plan, options, {6.5, 1.5, 0}), 4.5, kFloat_m);
  EXPECT_EQ(lookAhead(plan, options, {5.5, 1.5, 0}), lidar::kNoReturn);
  options.dark_range_m = 0;
  EXPECT_NEAR(lookAhead(plan, options, {5.5, 1.5, 0}), 5.5, kFloat_m);
}

TEST(Mirrors, ShowTheLengthOfTheWholeWayExactly) {
  const Plan plan =
      drawnPlan({"##########", "#........#", "#........M", "#........M", "#........M", "##########"});
  // Head on: to the mirror at x = 9 and back to the wall behind the robot at x = 1.
  EXPECT_NEAR(lookAhead(plan, ahead(), {3, 2.5, 0}), 6 + 8, kFloat_m);
  // Slanted, into the image of the room.
  const double angle_rad = degToRad(10);
  const double to_mirror_m = 6 / std::cos(angle_rad), back_m = 8 / std::cos(angle_rad);
  ASSERT_LT(2.1 + (to_mirror_m + back_m) * std::sin(angle_rad), 5);
  EXPECT_NEAR(lookAhead(plan, ahead(), {3, 2.1, angle_rad}), to_mirror_m + back_m, kFloat_m);
}

/// A plan beside its image in a mirror.
TEST(Mirrors, AreWindowsIntoTheImageOfTheRoom) {
  const std::vector<std::string> image = {"##########.##########", "#....#..............#",
                                          "#...................#", "#...........##......#",
                                          "#......#............#", "##########.##########"};
  std::vector<std::string> mirrored, doubled;
  for (const std::string& line : image) {
    const std::string half = line.substr(0, 10);
    mirrored.push_back(half + "M");
    doubled.push_back(half + std::string(half.rbegin(), half.rend()));
  }
  const Plan with_mirror = drawnPlan(mirrored), with_image = drawnPlan(doubled);
  core::RandomStream random(1, "mirror test");
  int through = 0;
  for (int i = 0; i < 2000; ++i) {
    const Pose2 pose{random.uniform(8.05, 9.9), random.uniform(1.1, 4.9), random.uniform(-kPi / 2, kPi / 2)};
    const float expected_m = lookAhead(with_image, ahead(), pose);
    const float found_m = lookAhead(with_mirror, ahead(), pose);
    // Only the image's side: what comes back out of the mirrored room would have to meet the mirror again.
    if (std::isinf(expected_m) || pose.x + expected_m * std::cos(pose.phi) < 10) continue;
    ++through;
    EXPECT_NEAR(found_m, expected_m, kFloat_m) << pose.x << " " << pose.y << " " << pose.phi;
  }
  EXPECT_GT(through, 200);
}

TEST(Mirrors, FacingEachOtherGiveNoReturn) {
  EXPECT_EQ(lookAhead(drawnPlan({"##########", "M........M", "##########"}), ahead(), {5, 1.5, 0}),
            lidar::kNoReturn);
}

TEST(Mirrors, BeyondTheMaximumRangeGiveNoReturn) {
  const Plan plan = drawnPlan({"#........M"});
  lidar::LidarOptions options = ahead();
  options.max_range_m = 13.9;  // 6 to the mirror, 8 back
  EXPECT_EQ(lookAhead(plan, options, {3, 0.5, 0}), lidar::kNoReturn);
  options.max_range_m = 5;
  EXPECT_EQ(lookAhead(plan, options, {3, 0.5, 0}), lidar::kNoReturn);
  options.max_range_m = 14.1;
  EXPECT_NEAR(lookAhead(plan, options, {3, 0.5, 0}), 14, kFloat_m);
}

TEST(Mirrors, AtFortyFiveDegreesTurnTheRayByARightAngle) {
  std::vector<std::string> lines;
  for (int row = 0; row < 20; ++row) {
    std::string line(20, '.');
    line[static_cast<size_t>(row)] = 'M';
    if (row == 0) line = std::string(20, '#');
    lines.push_back(line);
  }
  // The mirror falls from the upper left to the lower right: a ray from the upper right going left goes up.
  const Plan plan = drawnPlan(lines);
  const double y = 12.5, mirror_x = 20 - y;
  // Raster steps are a cell high, and the ray may meet a step's face anywhere in its cell.
  EXPECT_NEAR(lookAhead(plan, ahead(), {15, y, kPi}), (15 - mirror_x) + (19 - y), 1);
}

/// A pane at x = 5 between walls at x = 1 and x = 8.
Plan paned() {
  return drawnPlan({"#########", "#....G..#", "#....G..#", "#....G..#", "#########"});
}

TEST(Glass, AnswersLetsThroughOrMirrorsAsTheFormulasSay) {
  lidar::LidarOptions options = ahead();
  options.glass_echo = 0.4, options.glass_reflectance = 0.2;
  const int scans = 5000;
  const auto shares = sharesAhead(paned(), options, {2, 2.5, 0}, scans);
  ASSERT_EQ(shares.size(), 3U);
  const double expected[][2] = {{3, 0.4}, {6, 0.6 * 0.8}, {3 + 4, 0.6 * 0.2}};  // pane, behind, mirrored
  auto found = shares.begin();
  for (const auto& [range_m, share] : expected) {
    EXPECT_NEAR(found->first, range_m, kFloat_m);
    EXPECT_NEAR(found->second, share, kSigmas * binomialError(share, scans)) << range_m;
    ++found;
  }
}

TEST(Glass, IsSeenHalfAsOftenAtTheStatedIncidence) {
  lidar::LidarOptions options = ahead();
  options.glass_echo = 0.8, options.glass_echo_rad = degToRad(10), options.glass_reflectance = 0;
  const int scans = 5000;
  const double slant_rad = degToRad(10);
  const auto shares = sharesAhead(paned(), options, {2, 2.2, slant_rad}, scans);
  ASSERT_EQ(shares.size(), 2U);
  EXPECT_NEAR(shares.begin()->first, 3 / std::cos(slant_rad), kFloat_m);
  EXPECT_NEAR(shares.begin()->second, 0.4, kSigmas * binomialError(0.4, scans));
  EXPECT_NEAR(shares.rbegin()->first, 6 / std::cos(slant_rad), kFloat_m);
}

TEST(Glass, LetsRaysPassExactlyAsIfItWereNotThere) {
  const Plan clear = drawnPlan({"##########", "#........#", "#......#.#", "#........#", "##########"});
  const Plan glazed = drawnPlan({"##########", "#...GG...#", "#...GG.#.#", "#...G....#", "##########"});
  lidar::LidarOptions options = circle(720);
  options.glass_echo = options.glass_reflectance = 0;
  const Pose2 pose{2.3, 2.6, 0.1};
  const auto through = look(glazed, options, pose).ranges_m, expected = look(clear, options, pose).ranges_m;
  for (size_t i = 0; i < through.size(); ++i) EXPECT_NEAR(through[i], expected[i], kFloat_m) << i;
}

TEST(Glass, ActsAsAMirrorAtGrazingIncidence) {
  const Plan plan = drawnPlan({std::string(40, 'G'), std::string(39, '.') + "#"});
  // Along a pane at 1 degree: it mirrors nine rays in ten, down to the post at x = 39.
  const double slant_rad = degToRad(1);
  const auto shares = sharesAhead(plan, ahead(), {1, 0.7, slant_rad}, 2000);
  EXPECT_NEAR(shares.begin()->first, 38 / std::cos(slant_rad), kFloat_m);
  EXPECT_GT(shares.begin()->second, 0.9);
}

TEST(Glass, AtThePlansEdgeLetsRaysOut) {
  lidar::LidarOptions options = ahead();
  options.glass_echo = options.glass_reflectance = 0;
  EXPECT_EQ(lookAhead(drawnPlan({"#....G"}), options, {2, 0.5, 0}), lidar::kNoReturn);
  EXPECT_EQ(lookAhead(drawnPlan({"#....G"}), options, {2, 0.5, 0.1}), lidar::kNoReturn);
}

TEST(Glass, OnAWallShowsTheWall) {
  lidar::LidarOptions options = ahead();
  options.glass_echo = options.glass_reflectance = 0;
  EXPECT_NEAR(lookAhead(drawnPlan({"#....G#."}), options, {2, 0.5, 0}), 4, kFloat_m);
}

TEST(Glass, HidesNothingThatStandsBeforeIt) {
  const Plan plan = drawnPlan({"#...#.G..#"});
  EXPECT_NEAR(lookAhead(plan, ahead(), {2, 0.5, 0}), 2, kFloat_m);
}

TEST(LidarSensor, SeesAPlanOfPlainMaterialsAsOneWithout) {
  Plan plain = room(12, 9), named = plain;
  named.materials.assign(named.cells.size(), world::Material::kPlain);
  EXPECT_EQ(look(plain, circle(200), {4, 4, 0.1}).ranges_m, look(named, circle(200), {4, 4, 0.1}).ranges_m);
}

}  // namespace
}  // namespace slam::sim
