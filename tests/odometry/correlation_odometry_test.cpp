#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libslam/odometry/profile_correlation.h"
#include "tests/odometry/scene.h"

namespace slam::odometry {
namespace {

using core::degToRad;
using core::kPi;
using core::Pose2;
using scenes::between;
using scenes::isPositiveDefinite;
using scenes::Lidar;
using scenes::look;
using scenes::oddRoom;
using scenes::Scene;

struct Geometry {
  int beams;
  double fov_deg;
  double tolerance_m, tolerance_rad;  ///< without noise: what sampling corners by few beams costs
};

class EveryLidar : public ::testing::TestWithParam<Geometry> {
 protected:
  Lidar lidar() const {
    Lidar out;
    out.beams = GetParam().beams;
    out.fov_rad = degToRad(GetParam().fov_deg);
    return out;
  }
};

TEST_P(EveryLidar, FindsStepsAndTurnsOfTheUsualSize) {
  for (const Pose2 step : {Pose2{0.02, 0, 0}, Pose2{0.3, 0, 0}, Pose2{-0.15, 0, degToRad(-2)},
                           Pose2{0.2, 0.03, degToRad(20)}, Pose2{0.1, -0.05, degToRad(-20)}}) {
    const Pose2 start{0.3, 0.4, degToRad(25)};
    const auto motion =
        between("correlation", look(oddRoom(), start, lidar()), look(oddRoom(), start * step, lidar()));
    EXPECT_NEAR(motion.T_previous_current.x, step.x, GetParam().tolerance_m) << step.x << " " << step.phi;
    EXPECT_NEAR(motion.T_previous_current.y, step.y, GetParam().tolerance_m) << step.x << " " << step.phi;
    EXPECT_NEAR(motion.T_previous_current.phi, step.phi, GetParam().tolerance_rad)
        << step.x << " " << step.phi;
    EXPECT_TRUE(motion.reliable);
    EXPECT_TRUE(isPositiveDefinite(motion.covariance));
  }
}

// A lidar that gives a beam more at times heads half a step aside then: its beams are counted from the
// middle.
TEST(CorrelationOdometry, TheMountingOfEachScanCounts) {
  Lidar lidar;
  lidar.beams = 181, lidar.fov_rad = kPi;
  const Pose2 start{0.3, 0.4, degToRad(25)}, step{0.2, 0.03, degToRad(7)};
  auto before = look(oddRoom(), start, lidar), after = look(oddRoom(), start * step, lidar);
  const double half_step = before.step_rad / 2;
  before.ranges_m.pop_back();
  before.T_robot_lidar.phi -= half_step, before.first_angle_rad += half_step;
  EXPECT_TRUE(lidar::areOfOneLidar(before, after));
  for (const char* method : {"correlation", "plicp", "range_flow"}) {
    EXPECT_NEAR(between(method, before, after).T_previous_current.phi, step.phi, half_step / 4) << method;
    EXPECT_NEAR(between(method, after, before).T_previous_current.phi, -step.phi, half_step / 4) << method;
  }
  before.T_robot_lidar.phi += kPi;
  EXPECT_FALSE(lidar::areOfOneLidar(before, after)) << "one looks back";
}

TEST_P(EveryLidar, MirroredScansGiveTheMirroredMotion) {
  const Pose2 start{0.3, 0.4, degToRad(25)}, step{0.2, 0.03, degToRad(7)};
  auto before = look(oddRoom(), start, lidar()), after = look(oddRoom(), start * step, lidar());
  const auto motion = between("correlation", before, after);
  for (auto* scan : {&before, &after}) {
    std::reverse(scan->ranges_m.begin(), scan->ranges_m.end());
    scan->first_angle_rad = -scan->angle(scan->ranges_m.size() - 1);
  }
  const auto mirrored = between("correlation", before, after);
  // Lines grow to one side first and ties go to the lower beam, so the two agree only to the method's
  // accuracy.
  EXPECT_NEAR(mirrored.T_previous_current.x, motion.T_previous_current.x, GetParam().tolerance_m);
  EXPECT_NEAR(mirrored.T_previous_current.y, -motion.T_previous_current.y, GetParam().tolerance_m);
  EXPECT_NEAR(mirrored.T_previous_current.phi, -motion.T_previous_current.phi, GetParam().tolerance_rad);
}

TEST_P(EveryLidar, TheWayBackIsTheInverse) {
  const Pose2 start{0.3, 0.4, degToRad(25)}, step{0.2, 0.03, degToRad(7)};
  const auto a = look(oddRoom(), start, lidar()), b = look(oddRoom(), start * step, lidar());
  const Pose2 there = between("correlation", a, b).T_previous_current;
  const Pose2 round_trip = there * between("correlation", b, a).T_previous_current;
  EXPECT_NEAR(round_trip.x, 0, 2 * GetParam().tolerance_m);
  EXPECT_NEAR(round_trip.y, 0, 2 * GetParam().tolerance_m);
  EXPECT_NEAR(round_trip.phi, 0, 2 * GetParam().tolerance_rad);
}

INSTANTIATE_TEST_SUITE_P(Geometries, EveryLidar,
                         ::testing::Values(Geometry{90, 360, 0.02, 0.01}, Geometry{181, 180, 0.01, 0.005},
                                           Geometry{361, 180, 0.005, 0.002}, Geometry{361, 360, 0.005, 0.002},
                                           Geometry{541, 270, 0.005, 0.002},
                                           Geometry{1081, 270, 0.003, 0.001}),
                         [](const auto& geometry) {
                           return std::to_string(geometry.param.beams) + "BeamsOver" +
                                  std::to_string(static_cast<int>(geometry.param.fov_deg));
                         });

TEST(CorrelationOdometry, ALidarOffTheAxisStillGivesTheRobotsMotion) {
  Lidar lidar;
  lidar.beams = 541, lidar.fov_rad = degToRad(270);
  lidar.T_robot_lidar = {0.3, -0.1, degToRad(30)};
  const Pose2 start{0.2, 0.3, 0.4}, step{0.1, 0, degToRad(15)};
  const auto motion =
      between("correlation", look(oddRoom(), start, lidar), look(oddRoom(), start * step, lidar));
  EXPECT_NEAR(motion.T_previous_current.x, step.x, 0.005);
  EXPECT_NEAR(motion.T_previous_current.y, step.y, 0.005);
  EXPECT_NEAR(motion.T_previous_current.phi, step.phi, 0.002);
  // Against the same scans of a lidar on the axis: C_robot = J C_lidar J', J by differences.
  auto before = look(oddRoom(), start, lidar), after = look(oddRoom(), start * step, lidar);
  before.T_robot_lidar = after.T_robot_lidar = {};
  const auto bare = between("correlation", before, after);
  double J[3][3];
  for (int k = 0; k < 3; ++k) {
    constexpr double kSmall = 1e-6;
    Pose2 moved = bare.T_previous_current;
    (k == 0 ? moved.x : k == 1 ? moved.y : moved.phi) += kSmall;
    const auto inRobot = [&](const Pose2& T) {
      return lidar.T_robot_lidar * T * core::inverse(lidar.T_robot_lidar);
    };
    const Pose2 a = inRobot(bare.T_previous_current), b = inRobot(moved);
    J[0][k] = (b.x - a.x) / kSmall, J[1][k] = (b.y - a.y) / kSmall, J[2][k] = (b.phi - a.phi) / kSmall;
  }
  for (size_t r = 0; r < 3; ++r)
    for (size_t c = 0; c < 3; ++c) {
      double sum = 0;
      for (size_t i = 0; i < 3; ++i)
        for (size_t k = 0; k < 3; ++k) sum += J[r][i] * bare.covariance[3 * i + k] * J[c][k];
      EXPECT_NEAR(motion.covariance[3 * r + c], sum, 1e-4 * bare.covariance[0]) << "differences of 1e-6";
    }
  // The heading's error swings the robot's centre round the lidar, so the robot's x and heading go together.
  EXPECT_NE(motion.covariance[2], 0);
}

TEST(CorrelationOdometry, CopesWithNoiseAndLostReadings) {
  Lidar lidar;
  lidar.beams = 361, lidar.sigma_m = 0.02, lidar.drop_out = 0.2;
  core::RandomStream random(7, "lidar");
  const Pose2 start{0.3, 0.4, 0.5}, step{0.15, 0.02, 0.1};
  for (int run = 0; run < 20; ++run) {
    const auto motion = between("correlation", look(oddRoom(), start, lidar, &random),
                                look(oddRoom(), start * step, lidar, &random));
    // About five times the standard deviation that the covariance states.
    EXPECT_NEAR(motion.T_previous_current.x, step.x, 0.015);
    EXPECT_NEAR(motion.T_previous_current.y, step.y, 0.015);
    EXPECT_NEAR(motion.T_previous_current.phi, step.phi, 0.008);
    EXPECT_TRUE(motion.reliable);
  }
}

TEST(CorrelationOdometry, ItsCovarianceIsOfTheSizeOfItsErrors) {
  for (const double sigma : {0.01, 0.03}) {
    Lidar lidar;
    lidar.beams = 361, lidar.fov_rad = kPi, lidar.sigma_m = sigma;
    core::RandomStream random(3, "lidar");
    double sum = 0;
    constexpr int kRuns = 120;
    for (int run = 0; run < kRuns; ++run) {
      const Pose2 start{random.uniform(-0.5, 1.5), random.uniform(-0.5, 0.5), random.uniform(-kPi, kPi)};
      const Pose2 step{random.uniform(0, 0.2), 0, random.uniform(-0.1, 0.1)};
      const auto motion = between("correlation", look(oddRoom(), start, lidar, &random),
                                  look(oddRoom(), start * step, lidar, &random));
      const std::array<double, 3> error = {motion.T_previous_current.x - step.x,
                                           motion.T_previous_current.y - step.y,
                                           core::angleDifference(motion.T_previous_current.phi, step.phi)};
      sum += scenes::normalisedSquare(motion.covariance, error);
    }
    // 3 for a perfect covariance; the sampling error of the mean of 120 is 0.22. Within a factor of two in
    // the variance it is useful to a filter.
    EXPECT_GT(sum / kRuns, 1.5) << sigma;
    EXPECT_LT(sum / kRuns, 6.0) << sigma;
  }
}

TEST(CorrelationOdometry, AFeaturelessCorridorHasALargeVarianceAlongItAndASmallOneAcross) {
  Lidar lidar;
  lidar.beams = 361, lidar.max_range_m = 8, lidar.sigma_m = 0.01;
  core::RandomStream random(5, "lidar");
  const Scene corridor = Scene().add({{-50, -1}, {50, -1}}).add({{-50, 1}, {50, 1}});
  const auto motion = between("correlation", look(corridor, {0, 0.1, 0}, lidar, &random),
                              look(corridor, {0.2, 0.12, degToRad(2)}, lidar, &random));
  EXPECT_FALSE(motion.reliable);
  EXPECT_TRUE(isPositiveDefinite(motion.covariance));
  EXPECT_GT(motion.covariance[0], 0.2 * 0.2);
  EXPECT_LT(motion.covariance[0], 10.0) << "finite";
  // Across and in heading the walls tell: 1 cm noise over hundreds of beams.
  EXPECT_NEAR(motion.T_previous_current.y, 0.02, 0.01);
  EXPECT_NEAR(motion.T_previous_current.phi, degToRad(2), degToRad(0.3));
  EXPECT_LT(std::abs(motion.T_previous_current.x), 0.05) << "what is not seen is left at zero";
}

TEST(CorrelationOdometry, OneDoorInTheCorridorIsEnough) {
  // Among walls that fit wherever the robot stands, the door posts look like outliers until it is found
  // where.
  Lidar lidar;
  lidar.beams = 361, lidar.fov_rad = kPi, lidar.max_range_m = 8, lidar.sigma_m = 0.01;
  core::RandomStream random(5, "lidar");
  const Scene corridor = Scene()
                             .add({{-50, -1}, {1.5, -1}, {1.5, -1.3}, {2.5, -1.3}, {2.5, -1}, {50, -1}})
                             .add({{-50, 1}, {50, 1}});
  for (const double ahead : {0.05, 0.2, 0.3}) {
    const auto motion = between("correlation", look(corridor, {0, 0.1, 0}, lidar, &random),
                                look(corridor, {ahead, 0.12, degToRad(2)}, lidar, &random));
    EXPECT_TRUE(motion.reliable) << ahead;
    EXPECT_NEAR(motion.T_previous_current.x, ahead, 0.03) << "some 10 beams on one door post at 1 cm noise";
  }
}

TEST(CorrelationOdometry, ARoundRoomLeavesTheTurnUndetermined) {
  Scene round;
  constexpr int kSides = 720;
  for (int i = 0; i < kSides; ++i) {
    // Turned a little, so that no beam meets a corner and slips through it.
    const double a = 2 * kPi * (i + 0.3) / kSides, b = 2 * kPi * (i + 1.3) / kSides;
    round.add({{3 * std::cos(a), 3 * std::sin(a)}, {3 * std::cos(b), 3 * std::sin(b)}});
  }
  const auto motion = between("correlation", look(round, {0, 0, 0}, {}), look(round, {0.1, 0.05, 0.2}, {}));
  EXPECT_FALSE(motion.reliable);
  EXPECT_TRUE(isPositiveDefinite(motion.covariance));
  EXPECT_GT(motion.covariance[8], 0.05 * 0.05);
}

TEST(CorrelationOdometry, PeopleWalkingByDoNotCount) {
  const Pose2 start{0.3, 0.4, 0.5}, step{0.15, 0, 0.05};
  Scene with_person = oddRoom(), moved_person = oddRoom();
  with_person.box(2, -0.5, 2.4, 0.1);
  moved_person.box(2.2, -0.3, 2.6, 0.3);
  Lidar lidar;
  lidar.beams = 361;
  const auto motion =
      between("correlation", look(with_person, start, lidar), look(moved_person, start * step, lidar));
  EXPECT_NEAR(motion.T_previous_current.x, step.x, 0.005);
  EXPECT_NEAR(motion.T_previous_current.y, step.y, 0.005);
  EXPECT_NEAR(motion.T_previous_current.phi, step.phi, 0.003);
}

TEST(ProfileCorrelation, FindsATurnToAFractionOfABeam) {
  const auto before = look(oddRoom(), {0, 0, 0}, {});
  for (const double degrees : {0.0, 0.3, 12.5, -33.75}) {
    const auto peaks = correlateProfiles(before, look(oddRoom(), {0, 0, degToRad(degrees)}, {}), kPi / 3, 3);
    ASSERT_FALSE(peaks.empty());
    EXPECT_NEAR(peaks[0].turn_rad, degToRad(degrees), degToRad(0.4))
        << "jumps in the profile give the peak a cusp, which a parabola fits badly; whole beams miss by 0.5";
    EXPECT_GT(peaks[0].correlation, 0.99);
  }
}

TEST(ProfileCorrelation, EqualsItsPlainDefinition) {
  // Hand-sized: correlation of logarithms at every shift, by the book, over the circle.
  lidar::Scan before, after;
  before.first_angle_rad = after.first_angle_rad = -kPi;
  before.step_rad = after.step_rad = 2 * kPi / 12;
  before.max_range_m = after.max_range_m = 10;
  before.ranges_m = {1, 2, 3, 5, 4, 2, 2, 7, 1, 1, 3, 2};
  after.ranges_m = {3, 5, 4, 2.5, 2, 7, 1, 1, 3, 1.5, 1, lidar::kLostReading};
  double best = -2;
  int best_shift = 0;
  for (int shift = -6; shift <= 6; ++shift) {
    std::vector<double> x, y;
    for (int i = 0; i < 11; ++i) {
      x.push_back(std::log(static_cast<double>(before.ranges_m[static_cast<size_t>((i + shift + 12) % 12)])));
      y.push_back(std::log(static_cast<double>(after.ranges_m[static_cast<size_t>(i)])));
    }
    double mx = 0, my = 0, xx = 0, yy = 0, xy = 0;
    for (size_t i = 0; i < 11; ++i) mx += x[i] / 11, my += y[i] / 11;
    for (size_t i = 0; i < 11; ++i)
      xx += (x[i] - mx) * (x[i] - mx), yy += (y[i] - my) * (y[i] - my), xy += (x[i] - mx) * (y[i] - my);
    const double r = xy / std::sqrt(xx * yy);
    if (r > best) best = r, best_shift = shift;
  }
  const auto peaks = correlateProfiles(before, after, kPi, 1);
  ASSERT_EQ(peaks.size(), 1u);
  EXPECT_NEAR(peaks[0].correlation, best, 1e-12);
  EXPECT_EQ(best_shift, 2);
  EXPECT_NEAR(peaks[0].turn_rad / before.step_rad, best_shift, 0.5);
}

TEST(ProfileCorrelation, AFlatProfileHasNoPeak) {
  lidar::Scan scan;
  scan.first_angle_rad = -kPi;
  scan.step_rad = 2 * kPi / 90;
  scan.max_range_m = 10;
  scan.ranges_m.assign(90, 2.5f);
  EXPECT_TRUE(correlateProfiles(scan, scan, kPi, 3).empty());
}

}  // namespace
}  // namespace slam::odometry
