#include "libslam/mapping/particle_filter.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cstring>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "tests/mapping/small_room.h"

namespace slam::mapping {
namespace {

/// Two laps through a square ring corridor, 16 m outside and 2 m wide, with niches; ranges with 1 cm of noise, wheels
/// that turn 4 % too far, drift to the left and drive 3 % too long.
struct Ring {
  std::vector<robot::Scan> scans;
  std::vector<core::Pose2> wheels, truth;  ///< T_previous_robot; T_start_robot
};

std::vector<test::Wall> ringWalls() {
  std::vector<core::Point2> outer = {
      {0, 0},   {5, 0},  {5, -0.6}, {6, -0.6}, {6, 0},  {16, 0}, {16, 9}, {16.7, 9}, {16.7, 11},  {16, 11},
      {16, 16}, {4, 16}, {4, 16.5}, {2, 16.5}, {2, 16}, {0, 16}, {0, 7},  {-0.5, 7}, {-0.5, 6.2}, {0, 6.2}};
  std::vector<core::Point2> inner = {{2, 2},  {9, 2},  {9, 2.4}, {10, 2.4},
                                     {10, 2}, {14, 2}, {14, 14}, {2, 14}};
  std::vector<test::Wall> walls;
  for (const auto& loop : {outer, inner})
    for (size_t i = 0; i < loop.size(); ++i) walls.push_back({loop[i], loop[(i + 1) % loop.size()]});
  return walls;
}

Ring driveRound() {
  Ring ring;
  const auto walls = ringWalls();
  core::RandomStream noise(11, "ring");
  core::Pose2 T{1, 1, 0};
  const core::Pose2 T_start = T;
  const auto step = [&](const core::Pose2& motion) {
    T = T * motion;
    robot::Scan scan;
    const int beams = 181;
    scan.time_s = 0.2 * static_cast<double>(ring.scans.size());
    scan.first_angle_rad = -core::kPi / 2, scan.step_rad = core::kPi / (beams - 1), scan.max_range_m = 12;
    for (int i = 0; i < beams; ++i) {
      const double range_m = test::castRay(walls, T, scan.angle(static_cast<size_t>(i))) + noise.normal(0.01);
      scan.ranges_m.push_back(range_m < scan.max_range_m ? static_cast<float>(range_m) : robot::kNoReturn);
    }
    ring.scans.push_back(scan);
    ring.wheels.push_back({1.03 * motion.x, 0, 1.04 * motion.phi + 0.01 * motion.x + noise.normal(0.002)});
    ring.truth.push_back(core::between(T_start, T));
  };
  step({});
  for (int side = 0; side < 8; ++side) {
    for (int i = 0; i < 70; ++i) step({0.2, 0, 0});
    for (int i = 0; i < 10; ++i) step({0, 0, core::kPi / 20});
  }
  return ring;
}

const Ring& ring() {
  static const Ring kRing = driveRound();
  return kRing;
}

Motion motionOf(const core::Pose2& wheels) {
  const double xy = 0.02 + 0.1 * std::abs(wheels.x), turn = 0.05 + 0.2 * std::abs(wheels.phi);
  return {wheels, Eigen::Vector3d(xy * xy, xy * xy, turn * turn).asDiagonal()};
}

ParticleFilterOptions options(int count = 10, int threads = 1) {
  ParticleFilterOptions result;
  result.count = count, result.threads = threads;
  return result;
}

core::Trajectory run(ParticleFilter& filter, size_t scans = 10000) {
  core::Trajectory online;
  for (size_t i = 0; i < std::min(scans, ring().scans.size()); ++i)
    online.push_back(
        {ring().scans[i].time_s, filter.update(ring().scans[i], motionOf(ring().wheels[i])).T_map_robot});
  return online;
}

double worstError(const core::Trajectory& path) {
  double worst = 0;
  for (size_t i = 0; i < path.size(); ++i)
    worst = std::max(worst, core::distance(path[i].pose, ring().truth[i]));
  return worst;
}

bool sameBytes(const core::Trajectory& a, const core::Trajectory& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
}

TEST(ParticleFilter, BeatsItsOdometryByAFactorOfThirtyOnALoop) {
  core::Trajectory wheels;
  core::Pose2 T;
  for (size_t i = 0; i < ring().scans.size(); ++i) {
    if (i > 0) T = T * ring().wheels[i];
    wheels.push_back({0, T});
  }
  ParticleFilter filter(options(), 1);
  const auto online = run(filter);
  EXPECT_GT(worstError(wheels), 5);
  EXPECT_LT(worstError(online), worstError(wheels) / 30);
  ASSERT_EQ(filter.path().size(), ring().scans.size());
  EXPECT_LT(worstError(filter.path()), worstError(wheels) / 30);
}

TEST(ParticleFilter, GivesTheSameBytesWithAnyNumberOfThreads) {
  ParticleFilter one(options(10, 1), 3), other_seed(options(10, 1), 4);
  const auto online = run(one, 200);
  EXPECT_FALSE(sameBytes(online, run(other_seed, 200)));
  for (const int threads : {2, 5}) {
    ParticleFilter many(options(10, threads), 3);
    EXPECT_TRUE(sameBytes(run(many, 200), online)) << threads;
    EXPECT_TRUE(sameBytes(many.path(), one.path())) << threads;
    EXPECT_EQ(many.map().toRaster().occupancy, one.map().toRaster().occupancy) << threads;
    EXPECT_EQ(many.lastStep().covariance, one.lastStep().covariance) << threads;
  }
}

TEST(ParticleFilter, TheFirstScanIsTheOriginOfTheMap) {
  ParticleFilter filter(options(), 1);
  const auto& step = filter.update(ring().scans[0], motionOf({5, 5, 1}));
  EXPECT_EQ(step.T_map_robot.x, 0);
  EXPECT_EQ(step.T_map_robot.phi, 0);
  EXPECT_TRUE(step.inserted);
}

TEST(ParticleFilter, KeepsItsWayWithoutAnyOdometry) {
  ParticleFilter filter(options(), 1);
  const auto drive = test::driveThroughRoom();
  for (size_t i = 0; i < drive.entries.size(); ++i) {
    const auto& step = filter.update(drive.entries[i].scan, std::nullopt);
    EXPECT_LT(core::distance(step.T_map_robot, drive.truth[i]), 0.06) << i;
  }
}

TEST(ParticleFilter, EveryPoseHasACovariance) {
  ParticleFilter filter(options(), 2);
  run(filter, 1);
  for (size_t i = 1; i < 150; ++i) {
    const auto& step = filter.update(ring().scans[i], motionOf(ring().wheels[i]));
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(step.covariance);
    EXPECT_GT(solver.eigenvalues().minCoeff(), 0);
    EXPECT_LT(solver.eigenvalues().maxCoeff(), 1);
  }
}

TEST(ParticleFilter, DistrustsWheelsThatTurnTheWrongWay) {
  ParticleFilter filter(options(), 1);
  run(filter, 71);
  bool distrusted = false;
  for (size_t i = 71; i < 81; ++i) {
    auto wheels = ring().wheels[i];
    wheels.phi = -wheels.phi;
    distrusted |= filter.update(ring().scans[i], motionOf(wheels)).odometry_distrusted;
  }
  EXPECT_TRUE(distrusted);
  EXPECT_LT(std::abs(core::angleDifference(filter.lastStep().T_map_robot.phi, ring().truth[80].phi)),
            core::degToRad(1));
}

TEST(ParticleFilter, SaysThatItIsLostInAnotherPlaceAndBlindWithoutReturns) {
  ParticleFilter filter(options(), 1);
  run(filter, 50);
  auto blind = ring().scans[50];
  for (auto& range_m : blind.ranges_m) range_m = robot::kNoReturn;
  const auto& step = filter.update(blind, motionOf(ring().wheels[50]));
  EXPECT_TRUE(step.lost);
  EXPECT_TRUE(step.degenerate);
  EXPECT_TRUE(core::isFinite(step.T_map_robot));
}

TEST(ParticleFilter, LocalisesInAMapWithoutChangingIt) {
  ParticleFilter filter(options(), 1);
  run(filter, 60);
  const auto before = filter.map().toRaster().occupancy;
  filter.setMapping(false);
  for (size_t i = 60; i < 70; ++i)
    EXPECT_FALSE(filter.update(ring().scans[i], motionOf(ring().wheels[i])).inserted);
  EXPECT_EQ(filter.map().toRaster().occupancy, before);
  EXPECT_LT(core::distance(filter.lastStep().T_map_robot, ring().truth[69]), 0.1);
}

TEST(ParticleFilter, StartsInAKnownMapAtAGivenPose) {
  std::vector<std::pair<gridmap::ScanRays, core::Pose2>> known;
  for (size_t i = 0; i < 60; i += 2)
    known.emplace_back(gridmap::scanRays(ring().scans[i], {}), ring().truth[i]);
  ParticleFilter filter(options(), 1);
  const core::Pose2& truth = ring().truth[40];
  filter.start({truth.x + 0.1, truth.y - 0.1, truth.phi + 0.05}, known);
  const auto& step = filter.update(ring().scans[40], motionOf({}));
  EXPECT_LT(core::distance(step.T_map_robot, truth), 0.05);
  EXPECT_THROW(filter.start({}, {}), core::ContractError);
}

TEST(ParticleFilter, ParticlesShareWhatTheyHaveInCommon) {
  ParticleFilter one(options(1), 1), many(options(30), 1);
  run(one, 300), run(many, 300);
  EXPECT_LT(many.bytes(), 15 * one.bytes());
}

TEST(ParticleFilter, RefusesAMotionThatIsNotFinite) {
  ParticleFilter filter(options(2), 1);
  EXPECT_THROW(filter.update(ring().scans[0], motionOf({NAN, 0, 0})), core::ContractError);
}

}  // namespace
}  // namespace slam::mapping
