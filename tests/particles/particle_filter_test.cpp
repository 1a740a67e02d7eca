#include "libslam/particles/particle_filter.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstring>
#include <string>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "tests/mapping/small_room.h"

namespace slam::particles {
namespace {

/// Two laps through a square ring corridor, 16 m outside and 2 m wide, with niches; ranges with 1 cm of
/// noise, wheels that turn 4 % too far, drift to the left and drive 3 % too long.
struct Ring {
  std::vector<robot::Scan> scans;
  std::vector<core::Pose2> wheels, truth;  ///< T_previous_robot; T_start_robot
};

std::vector<mapping::test::Wall> ringWalls() {
  std::vector<core::Point2> outer = {
      {0, 0},   {5, 0},  {5, -0.6}, {6, -0.6}, {6, 0},  {16, 0}, {16, 9}, {16.7, 9}, {16.7, 11},  {16, 11},
      {16, 16}, {4, 16}, {4, 16.5}, {2, 16.5}, {2, 16}, {0, 16}, {0, 7},  {-0.5, 7}, {-0.5, 6.2}, {0, 6.2}};
  std::vector<core::Point2> inner = {{2, 2},  {9, 2},  {9, 2.4}, {10, 2.4},
                                     {10, 2}, {14, 2}, {14, 14}, {2, 14}};
  std::vector<mapping::test::Wall> walls;
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
      const double range_m =
          mapping::test::castRay(walls, T, scan.angle(static_cast<size_t>(i))) + noise.normal(0.01);
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
  const auto drive = mapping::test::driveThroughRoom();
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

int count(const ParticleFilter& filter, const std::string& event) {
  return static_cast<int>(std::count_if(
      filter.journal().begin(), filter.journal().end(),
      [&](const core::JournalEntry& entry) { return core::wordOf(entry.event) == std::string(event); }));
}

robot::Scan withoutReturns(robot::Scan scan) {
  for (auto& range_m : scan.ranges_m) range_m = robot::kNoReturn;
  return scan;
}

// A blind lidar once cleared the walls around the robot out of every map: its beams met nothing for 12 m.
TEST(ParticleFilter, BlindItFollowsTheOdometryAndLeavesItsMapAlone) {
  ParticleFilter filter(options(), 1);
  run(filter, 50);
  const auto map = filter.map().toRaster().occupancy;
  const core::Pose2 T = filter.lastStep().T_map_robot;
  const core::Pose2 wheels{0.2, 0, 0.01};
  for (int i = 0; i < 60; ++i) {
    const auto& step =
        filter.update(withoutReturns(ring().scans[50]), motionOf(i == 0 ? wheels : core::Pose2{}));
    EXPECT_TRUE(step.lost && step.degenerate && !step.inserted) << i;
  }
  EXPECT_LT(core::distance(filter.lastStep().T_map_robot, T * wheels), 1e-9);
  EXPECT_EQ(filter.map().toRaster().occupancy, map);
  // It opens its eyes again where the odometry says that it is.
  EXPECT_FALSE(filter.update(ring().scans[50], motionOf({})).lost);
  EXPECT_EQ(count(filter, "lost"), 1);
  EXPECT_EQ(count(filter, "recovered"), 1);
  EXPECT_EQ(count(filter, "restarted"), 0);
}

TEST(ParticleFilter, KidnappedItSaysSoAndMapsOnFromWhereItIs) {
  auto some = options();
  some.lost_scans = 5;
  ParticleFilter filter(some, 1);
  run(filter, 60);
  const size_t bytes = filter.bytes();
  const auto room = mapping::test::driveThroughRoom(20);
  int lost = 0, inserted = 0;
  for (const auto& entry : room.entries) {
    const auto& step = filter.update(entry.scan, motionOf(entry.T_previous_robot));
    EXPECT_TRUE(core::isFinite(step.T_map_robot));
    lost += step.lost, inserted += step.inserted;
  }
  EXPECT_EQ(lost, 5);
  EXPECT_GE(inserted, 1);
  ASSERT_EQ(count(filter, "lost"), 1);
  EXPECT_EQ(count(filter, "restarted"), 1);
  const auto entry =
      std::find_if(filter.journal().begin(), filter.journal().end(),
                   [](const core::JournalEntry& e) { return e.event == core::JournalEvent::kLost; });
  EXPECT_EQ(entry->scan, 60);
  EXPECT_LT(entry->value, some.lost_score);
  EXPECT_EQ(filter.path().size(), 80U);
  EXPECT_LT(filter.bytes(), 2 * bytes);
}

TEST(ParticleFilter, TheJournalCountsWhatTheStepsSay) {
  ParticleFilter filter(options(), 1);
  int resampled = 0, distrusted = 0, degenerate = 0;
  for (size_t i = 0; i < 300; ++i) {
    const auto& step = filter.update(ring().scans[i], motionOf(ring().wheels[i]));
    resampled += step.resampled, distrusted += step.odometry_distrusted, degenerate += step.degenerate;
    if (!step.resampled) continue;
    EXPECT_EQ(filter.journal().back().event, core::JournalEvent::kResampled);
    EXPECT_EQ(filter.journal().back().scan, static_cast<int>(i));
    EXPECT_EQ(filter.journal().back().value, step.effective_share);
    EXPECT_LT(step.effective_share, options().resample_below);
  }
  EXPECT_GT(resampled, 0);
  EXPECT_EQ(count(filter, "resampled"), resampled);
  EXPECT_EQ(count(filter, "distrusted"), distrusted);
  EXPECT_EQ(count(filter, "degenerate"), degenerate);
  EXPECT_EQ(count(filter, "lost"), 0);
}

// The clean part of the corridor, its ends out of sight.
TEST(ParticleFilter, ACorridorIsDegenerateAndHeldByTheWheelsAlong) {
  ParticleFilter filter(options(), 1);
  const std::vector<mapping::test::Wall> walls = {{{-100, -1}, {100, -1}}, {{-100, 1}, {100, 1}}};
  for (int i = 0; i < 60; ++i) {
    robot::Scan scan;
    scan.time_s = 0.2 * i, scan.max_range_m = 12;
    scan.first_angle_rad = -core::kPi / 2, scan.step_rad = core::kPi / 180;
    for (size_t k = 0; k < 181; ++k) {
      const double range_m = mapping::test::castRay(walls, {0.2 * i, 0, 0}, scan.angle(k));
      scan.ranges_m.push_back(range_m < 12 ? static_cast<float>(range_m) : robot::kNoReturn);
    }
    filter.update(scan, motionOf({0.2, 0, 0}));
  }
  EXPECT_GT(count(filter, "degenerate"), 50);
  const auto& step = filter.lastStep();
  EXPECT_NEAR(step.T_map_robot.x, 59 * 0.2, 0.1);
  EXPECT_NEAR(step.T_map_robot.y, 0, 0.02);
  EXPECT_GT(step.covariance(0, 0), 4 * step.covariance(1, 1));
}

// Normalised estimation error squared, 3 degrees of freedom, of the poses given online. The bounds are wide:
// two runs in one building are few.
TEST(ParticleFilter, TheCovarianceCoversTheDriftOfTheMap) {
  double nees = 0;
  int poses = 0;
  for (const std::uint64_t seed : {1, 2}) {
    ParticleFilter filter(options(), seed);
    for (size_t i = 0; i < 320; ++i) {
      const auto& step = filter.update(ring().scans[i], motionOf(ring().wheels[i]));
      if (i == 0) continue;
      const core::Pose2& truth = ring().truth[i];
      const Eigen::Vector3d error(step.T_map_robot.x - truth.x, step.T_map_robot.y - truth.y,
                                  core::angleDifference(step.T_map_robot.phi, truth.phi));
      nees += error.dot(step.covariance.ldlt().solve(error)) / 3;
      ++poses;
    }
  }
  EXPECT_LT(nees / poses, 3);
  EXPECT_GT(nees / poses, 0.03);
}

// Back where it began, the robot hangs on the first scans again, whatever the way was.
TEST(ParticleFilter, TheDriftIsForgottenWhereTheMapIsOld) {
  ParticleFilter filter(options(), 1);
  double there = 0, back = 0;
  for (size_t i = 0; i < 400; ++i) {
    const auto& step = filter.update(ring().scans[i], motionOf(ring().wheels[i]));
    const double trace = step.covariance(0, 0) + step.covariance(1, 1);
    if (i >= 150 && i < 200) there = std::max(there, trace);
    if (i >= 335 && i < 385) back = std::max(back, trace);
  }
  EXPECT_LT(back, there / 2);
}

// Fox 2003, equation 7 worked by hand: 2 bins: (1 / 0.1) (1 - 2/9 + sqrt(2/9) 2.3263)^3 = 65.86; 101 bins:
// (100 / 0.1) (1 - 2/900 + sqrt(2/900) 2.3263)^3 = 1358.2. The exact quantiles of chi-square, 6.635 and
// 135.81, give 66.35 and 1358.1.
TEST(KldParticles, FollowTheBoundOfFox) {
  EXPECT_EQ(kldParticles(1, 0.05), 1U);
  EXPECT_EQ(kldParticles(2, 0.05), 66U);
  EXPECT_EQ(kldParticles(101, 0.05), 1359U);
  EXPECT_LT(kldParticles(101, 0.1), kldParticles(101, 0.05));
  for (size_t bins = 1; bins < 50; ++bins) EXPECT_LT(kldParticles(bins, 0.1), kldParticles(bins + 1, 0.1));
  EXPECT_THROW(kldParticles(0, 0.1), core::ContractError);
  EXPECT_THROW(kldParticles(3, 0), core::ContractError);
}

TEST(ParticleFilter, KldSamplingStaysBetweenItsBoundsAndFollowsTheSpread) {
  auto kld = options(20);
  kld.sampling = "kld", kld.least_count = 5, kld.most_count = 40;
  auto fine = kld, coarse = kld;
  fine.kld_bin_m = 0.001, fine.kld_bin_rad = 0.0005;
  coarse.kld_bin_m = 10, coarse.kld_bin_rad = 1;
  ParticleFilter many(fine, 1), few(coarse, 1);
  for (size_t i = 0; i < 200; ++i) {
    for (auto* filter : {&many, &few}) {
      filter->update(ring().scans[i], motionOf(ring().wheels[i]));
      EXPECT_GE(filter->particles(), 5);
      EXPECT_LE(filter->particles(), 40);
    }
  }
  EXPECT_EQ(few.particles(), 5);
  EXPECT_GT(many.particles(), 20);
  EXPECT_EQ(many.path().size(), 200U);
}

TEST(ParticleFilter, KldSamplingGivesTheSameBytesWithAnyNumberOfThreads) {
  auto one = options(20, 1);
  one.sampling = "kld", one.least_count = 5, one.most_count = 40;
  auto four = one;
  four.threads = 4;
  ParticleFilter single(one, 3), parallel(four, 3);
  EXPECT_TRUE(sameBytes(run(single, 150), run(parallel, 150)));
  EXPECT_EQ(single.particles(), parallel.particles());
  EXPECT_TRUE(sameBytes(single.path(), parallel.path()));
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

/// The ring's walls five times as large: house fronts around a yard of 80 m, nothing else within reach of
/// indoor settings.
robot::Scan scanInYard(const core::Pose2& T, core::RandomStream& noise) {
  std::vector<mapping::test::Wall> walls = ringWalls();
  walls.resize(20);  // without the block in its middle
  for (auto& wall : walls) wall = {{5 * wall.a.x, 5 * wall.a.y}, {5 * wall.b.x, 5 * wall.b.y}};
  robot::Scan scan;
  scan.first_angle_rad = -core::kPi, scan.step_rad = core::kPi / 180, scan.max_range_m = 80;
  for (size_t i = 0; i < 360; ++i) {
    const double range_m = mapping::test::castRay(walls, T, scan.angle(i)) + noise.normal(0.01);
    scan.ranges_m.push_back(range_m < scan.max_range_m ? static_cast<float>(range_m) : robot::kNoReturn);
  }
  return scan;
}

TEST(ParticleFilter, ReachesAsFarAsTheRangesGo) {
  core::RandomStream noise(3, "yard");
  ParticleFilter filter(options(5), 1);
  core::Pose2 T{40, 40, 0.3};
  const core::Pose2 T_start = T;
  for (int i = 0; i < 60; ++i) {
    if (i > 0) T = T * core::Pose2{0.2, 0, 0.02};
    const auto& step =
        filter.update(scanInYard(T, noise), motionOf({i > 0 ? 0.21 : 0.0, 0, i > 0 ? 0.02 : 0.0}));
    ASSERT_FALSE(step.lost) << "scan " << i;
  }
  EXPECT_GT(filter.rays().max_range_m, 40);
  EXPECT_LT(core::distance(filter.lastStep().T_map_robot, core::between(T_start, T)), 0.05);
  // Indoors nothing changes.
  ParticleFilter inside(options(5), 1);
  run(inside, 20);
  EXPECT_EQ(inside.rays().max_range_m, ParticleFilterOptions().rays.max_range_m);
}

TEST(ParticleFilter, RefusesAMotionThatIsNotFinite) {
  ParticleFilter filter(options(2), 1);
  EXPECT_THROW(filter.update(ring().scans[0], motionOf({NAN, 0, 0})), core::ContractError);
}

}  // namespace
}  // namespace slam::particles
