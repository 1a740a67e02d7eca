#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/odometry/scene.h"

// What the two methods that go on from the step before do, scene by scene; correlation_odometry_test.cpp
// holds the same for the one that searches.
namespace slam::odometry {
namespace {

using core::degToRad;
using core::kPi;
using core::Pose2;
using scenes::isPositiveDefinite;
using scenes::Lidar;
using scenes::look;
using scenes::oddRoom;
using scenes::Scene;

class DenseMethod : public ::testing::TestWithParam<std::string> {
 protected:
  ScanMotion between(const lidar::Scan& before, const lidar::Scan& after) const {
    return scenes::between(GetParam().c_str(), before, after);
  }
};

INSTANTIATE_TEST_SUITE_P(Both, DenseMethod, ::testing::Values("range_flow", "plicp"),
                         [](const auto& method) { return method.param; });

TEST_P(DenseMethod, FindsStepsAndTurnsOfTheUsualSizeWithEveryLidar) {
  struct Geometry {
    int beams;
    double fov_deg, tolerance_m, tolerance_rad;  // without noise: what corners between beams cost
  };
  for (const Geometry& g :
       {Geometry{90, 360, 0.03, 0.015}, Geometry{181, 180, 0.01, 0.005}, Geometry{361, 180, 0.01, 0.004},
        Geometry{361, 360, 0.01, 0.004}, Geometry{541, 270, 0.01, 0.004}, Geometry{1081, 270, 0.01, 0.003}}) {
    Lidar lidar;
    lidar.beams = g.beams, lidar.fov_rad = degToRad(g.fov_deg);
    for (const Pose2 step : {Pose2{0.02, 0, 0}, Pose2{0.2, 0, 0}, Pose2{-0.15, 0, degToRad(-2)},
                             Pose2{0.1, 0.03, degToRad(8)}, Pose2{0.1, -0.05, degToRad(-20)}}) {
      const Pose2 start{0.3, 0.4, degToRad(25)};
      const auto motion = between(look(oddRoom(), start, lidar), look(oddRoom(), start * step, lidar));
      const auto where = std::to_string(g.beams) + " beams, " + std::to_string(step.x) + " m";
      EXPECT_NEAR(motion.T_previous_current.x, step.x, g.tolerance_m) << where;
      EXPECT_NEAR(motion.T_previous_current.y, step.y, g.tolerance_m) << where;
      EXPECT_NEAR(motion.T_previous_current.phi, step.phi, g.tolerance_rad) << where;
      EXPECT_TRUE(motion.reliable) << where;
      EXPECT_TRUE(isPositiveDefinite(motion.covariance)) << where;
    }
  }
}

TEST_P(DenseMethod, MirroredScansGiveTheMirroredMotion) {
  Lidar lidar;
  lidar.beams = 361, lidar.fov_rad = kPi;
  const Pose2 start{0.3, 0.4, degToRad(25)}, step{0.15, 0.03, degToRad(5)};
  auto before = look(oddRoom(), start, lidar), after = look(oddRoom(), start * step, lidar);
  const auto motion = between(before, after);
  for (auto* scan : {&before, &after}) std::reverse(scan->ranges_m.begin(), scan->ranges_m.end());
  const auto mirrored = between(before, after);
  // Ties go to the lower beam, so the two agree only to the method's accuracy.
  EXPECT_NEAR(mirrored.T_previous_current.x, motion.T_previous_current.x, 0.003);
  EXPECT_NEAR(mirrored.T_previous_current.y, -motion.T_previous_current.y, 0.003);
  EXPECT_NEAR(mirrored.T_previous_current.phi, -motion.T_previous_current.phi, 0.002);
}

TEST_P(DenseMethod, CopesWithNoiseLostReadingsAndNoReturns) {
  Lidar lidar;
  lidar.beams = 361, lidar.sigma_m = 0.02, lidar.drop_out = 0.2, lidar.max_range_m = 4.5;
  core::RandomStream random(7, "lidar");
  const Pose2 start{0.3, 0.4, 0.5}, step{0.15, 0.02, 0.1};
  for (int run = 0; run < 20; ++run) {
    const auto motion =
        between(look(oddRoom(), start, lidar, &random), look(oddRoom(), start * step, lidar, &random));
    // About five times the standard deviation that the covariance states.
    EXPECT_NEAR(motion.T_previous_current.x, step.x, 0.02);
    EXPECT_NEAR(motion.T_previous_current.y, step.y, 0.02);
    EXPECT_NEAR(motion.T_previous_current.phi, step.phi, 0.01);
    EXPECT_TRUE(motion.reliable);
  }
}

TEST_P(DenseMethod, ItsCovarianceIsOfTheSizeOfItsErrors) {
  for (const double sigma : {0.01, 0.03}) {
    Lidar lidar;
    lidar.beams = 361, lidar.fov_rad = kPi, lidar.sigma_m = sigma;
    core::RandomStream random(3, "lidar");
    double sum = 0;
    constexpr int kRuns = 240;
    for (int run = 0; run < kRuns; ++run) {
      const Pose2 start{random.uniform(-0.5, 1.5), random.uniform(-0.5, 0.5), random.uniform(-kPi, kPi)};
      const Pose2 step{random.uniform(0, 0.2), 0, random.uniform(-0.1, 0.1)};
      const auto motion =
          between(look(oddRoom(), start, lidar, &random), look(oddRoom(), start * step, lidar, &random));
      sum += scenes::normalisedSquare(
          motion.covariance, {motion.T_previous_current.x - step.x, motion.T_previous_current.y - step.y,
                              core::angleDifference(motion.T_previous_current.phi, step.phi)});
    }
    // 3 for a perfect covariance; the sampling error of the mean of 120 is 0.22. Within a factor of two in
    // the variance it is useful to a filter.
    EXPECT_GT(sum / kRuns, 1.5) << sigma;
    EXPECT_LT(sum / kRuns, 6.0) << sigma;
  }
}

TEST_P(DenseMethod, AFeaturelessCorridorIsReportedAndItsWallsStillTellTheRest) {
  Lidar lidar;
  lidar.beams = 361, lidar.max_range_m = 8, lidar.sigma_m = 0.01;
  core::RandomStream random(5, "lidar");
  const Scene corridor = Scene().add({{-50, -1}, {50, -1}}).add({{-50, 1}, {50, 1}});
  const auto motion = between(look(corridor, {0, 0.1, 0}, lidar, &random),
                              look(corridor, {0.2, 0.12, degToRad(2)}, lidar, &random));
  EXPECT_FALSE(motion.reliable);
  EXPECT_TRUE(isPositiveDefinite(motion.covariance));
  EXPECT_GT(motion.covariance[0], 0.2 * 0.2);
  EXPECT_LT(motion.covariance[0], 10.0) << "finite";
  EXPECT_NEAR(motion.T_previous_current.y, 0.02, 0.01) << "1 cm noise over hundreds of beams";
  EXPECT_NEAR(motion.T_previous_current.phi, degToRad(2), degToRad(0.3));
  EXPECT_LT(std::abs(motion.T_previous_current.x), 0.05) << "what is not seen is left at zero";
}

TEST_P(DenseMethod, KeepsTheSpeedAlongACorridorWhereNothingTellsIt) {
  // A room, then a corridor without features: 0.15 m per scan all the way.
  Lidar lidar;
  lidar.beams = 361, lidar.max_range_m = 8, lidar.sigma_m = 0.005;
  core::RandomStream random(6, "lidar");
  const Scene scene = Scene()
                          .add({{0, 1}, {-4, 1}, {-4, -3}, {0, -3}, {0, -1}})
                          .add({{0, -1}, {60, -1}})
                          .add({{0, 1}, {60, 1}});
  const auto odometry = scenes::make(GetParam().c_str());
  Pose2 pose{-2, 0, 0}, estimate = pose;
  odometry->update(look(scene, pose, lidar, &random));
  int flagged = 0;
  for (int i = 0; i < 120; ++i) {
    pose.x += 0.15;
    const auto motion = odometry->update(look(scene, pose, lidar, &random));
    estimate = estimate * motion.T_previous_current;
    flagged += motion.reliable ? 0 : 1;
  }
  EXPECT_GT(flagged, 20) << "of the 50 steps deep inside, most have nothing to go by";
  // Some 60 steps go by the speed of the last ones that were seen, which is known to a few millimetres.
  EXPECT_NEAR(estimate.x, pose.x, 1.0) << "without the speed 9 m would be missing";
}

/// What a method says of a robot that stands in a corridor without features, where nothing tells the way
/// along it, after it saw steps of 0.2 m; `between` is what came between.
template <typename Between>
ScanMotion standingInACorridorAfterSteps(const std::string& method, const Between& between) {
  Lidar lidar;
  lidar.beams = 361, lidar.max_range_m = 8;
  const Scene corridor = Scene().add({{-50, -1}, {50, -1}}).add({{-50, 1}, {50, 1}});
  const auto odometry = scenes::make(method.c_str());
  odometry->update(look(oddRoom(), {0, 0, 0}, lidar));
  odometry->update(look(oddRoom(), {0.2, 0, 0}, lidar));
  between(*odometry, look(Scene(), {}, lidar));
  odometry->update(look(corridor, {0, 0, 0}, lidar));
  return odometry->update(look(corridor, {0, 0, 0}, lidar));
}

TEST_P(DenseMethod, AfterAResetNothingIsPredicted) {
  const auto motion = standingInACorridorAfterSteps(
      GetParam(), [](ScanOdometry& odometry, const lidar::Scan&) { odometry.reset(); });
  EXPECT_NEAR(motion.T_previous_current.x, 0, 0.01);
}

TEST_P(DenseMethod, AfterABlindScanNothingIsPredicted) {
  const auto motion = standingInACorridorAfterSteps(
      GetParam(), [](ScanOdometry& odometry, const lidar::Scan& blind) { odometry.update(blind); });
  EXPECT_NEAR(motion.T_previous_current.x, 0, 0.01);
}

TEST_P(DenseMethod, ALidarOffTheAxisStillGivesTheRobotsMotion) {
  Lidar lidar;
  lidar.beams = 541, lidar.fov_rad = degToRad(270);
  lidar.T_robot_lidar = {0.3, -0.1, degToRad(30)};
  const Pose2 start{0.2, 0.3, 0.4}, step{0.1, 0, degToRad(8)};
  const auto motion = between(look(oddRoom(), start, lidar), look(oddRoom(), start * step, lidar));
  EXPECT_NEAR(motion.T_previous_current.x, step.x, 0.01);
  EXPECT_NEAR(motion.T_previous_current.y, step.y, 0.01);
  EXPECT_NEAR(motion.T_previous_current.phi, step.phi, 0.004);
}

TEST_P(DenseMethod, PeopleWalkingByDoNotCount) {
  const Pose2 start{0.3, 0.4, 0.5}, step{0.15, 0, 0.05};
  Scene with_person = oddRoom(), moved_person = oddRoom();
  with_person.box(2, -0.5, 2.4, 0.1);
  moved_person.box(2.2, -0.3, 2.6, 0.3);
  Lidar lidar;
  lidar.beams = 361;
  const auto motion = between(look(with_person, start, lidar), look(moved_person, start * step, lidar));
  EXPECT_NEAR(motion.T_previous_current.x, step.x, 0.01);
  EXPECT_NEAR(motion.T_previous_current.y, step.y, 0.01);
  EXPECT_NEAR(motion.T_previous_current.phi, step.phi, 0.004);
}

TEST_P(DenseMethod, AnUnexpectedTurnIsFoundByTheProfiles) {
  // Standing, then 45 degrees at once: neither a gradient nor a nearest point leads there.
  Lidar lidar;
  lidar.beams = 361;
  const auto odometry = scenes::make(GetParam().c_str());
  odometry->update(look(oddRoom(), {0.3, 0.4, 0}, lidar));
  odometry->update(look(oddRoom(), {0.3, 0.4, 0}, lidar));
  const auto motion = odometry->update(look(oddRoom(), {0.3, 0.4, degToRad(45)}, lidar));
  EXPECT_NEAR(motion.T_previous_current.phi, degToRad(45), 0.004);
  EXPECT_NEAR(motion.T_previous_current.x, 0, 0.01);
}

TEST(RangeFlowOdometry, ErrorsDoNotAddUpWhileTheRobotStaysNearOneScan) {
  Lidar lidar;
  lidar.beams = 361, lidar.fov_rad = kPi, lidar.sigma_m = 0.02;
  core::RandomStream random(9, "lidar");
  double of_steps = 0, of_chains = 0, consistency = 0;
  constexpr int kRuns = 24, kSteps = 15;
  for (int run = 0; run < kRuns; ++run) {
    const auto odometry = scenes::make("range_flow");
    Pose2 pose{random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-kPi, kPi)};
    const Pose2 step{0.02, 0, 0.01};
    odometry->update(look(oddRoom(), pose, lidar, &random));
    Pose2 chain;
    for (int i = 0; i < kSteps; ++i) {
      pose = pose * step;
      const auto motion = odometry->update(look(oddRoom(), pose, lidar, &random));
      const Pose2 error = core::between(step, motion.T_previous_current);
      of_steps += (error.x * error.x + error.y * error.y) / kSteps;
      consistency += scenes::normalisedSquare(motion.covariance, {error.x, error.y, error.phi}) / kSteps;
      chain = chain * motion.T_previous_current;
    }
    Pose2 truth;
    for (int i = 0; i < kSteps; ++i) truth = truth * step;
    of_chains += std::pow(core::distance(truth, chain), 2);
  }
  // Against one scan the error of the chain is that of its last step. From scan to scan this gives 1.25 here,
  // and not the 3.9 of independent errors: the noise of a scan enters the steps before and after it with
  // opposite signs.
  EXPECT_LT(std::sqrt(of_chains / of_steps), 1.1);
  // 3 when perfect. Two errors in each step share the noise of the reference scan, so it may be smaller.
  EXPECT_GT(consistency / kRuns, 0.7);
  EXPECT_LT(consistency / kRuns, 6.0);
}

}  // namespace
}  // namespace slam::odometry
