#include "libslam/particles/particle_filter.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <string>

#include "libslam/core/error.h"
#include "tests/mapping/small_room.h"
#include "tests/particles/ring.h"

namespace slam::particles {
namespace {

using namespace ring_drive;

double worstError(const core::Trajectory& path) {
  double worst = 0;
  for (size_t i = 0; i < path.size(); ++i)
    worst = std::max(worst, core::distance(path[i].pose, ring().truth[i]));
  return worst;
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

// What weighs no particle need not be matched to thirty maps.
TEST(ParticleFilter, BetweenInsertionsAllParticlesGoWithTheBest) {
  const auto goApart = [](bool mapping) {
    ParticleFilter filter(options(), 1);
    int together = 0, apart = 0;
    for (size_t i = 0; i < 100; ++i) {
      filter.setMapping(mapping || i < 60);
      const auto before = filter.poses();
      const auto& step = filter.update(ring().scans[i], motionOf(ring().wheels[i]));
      if (step.inserted || step.lost) continue;
      const core::Pose2 went = core::between(before[0], filter.poses()[0]);
      for (size_t k = 1; k < before.size(); ++k) {
        const core::Pose2 of_k = core::between(before[k], filter.poses()[k]);
        const bool is_same = core::distance(of_k, went) < 1e-9 && std::abs(of_k.phi - went.phi) < 1e-9;
        ++(is_same ? together : apart);
      }
    }
    EXPECT_GT(together, 300);
    return apart;
  };
  EXPECT_EQ(goApart(true), 0);
  EXPECT_EQ(goApart(false), 0) << "in a finished map";
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

lidar::Scan withoutReturns(lidar::Scan scan) {
  for (auto& range_m : scan.ranges_m) range_m = lidar::kNoReturn;
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
  // As the drive so far has shown its wheels to err.
  EXPECT_LT(core::distance(filter.lastStep().T_map_robot, T * wheels), 0.01);
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

TEST(ParticleFilter, KidnappedItMapsOnBeforeItHasGoneFar) {
  auto some = options();
  some.lost_m = 0.28;
  ParticleFilter filter(some, 1);
  run(filter, 60);
  int lost = 0;
  for (const auto& entry : mapping::test::driveThroughRoom(20).entries)  // 0.06 m a scan
    lost += filter.update(entry.scan, motionOf(entry.T_previous_robot)).lost;
  EXPECT_EQ(lost, 6);  // the first did not move
  EXPECT_EQ(count(filter, "restarted"), 1);
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
    lidar::Scan scan;
    scan.time_s = 0.2 * i, scan.max_range_m = 12;
    scan.first_angle_rad = -core::kPi / 2, scan.step_rad = core::kPi / 180;
    for (size_t k = 0; k < 181; ++k) {
      const double range_m = mapping::test::castRay(walls, {0.2 * i, 0, 0}, scan.angle(k));
      scan.ranges_m.push_back(range_m < 12 ? static_cast<float>(range_m) : lidar::kNoReturn);
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
lidar::Scan scanInYard(const core::Pose2& T, core::RandomStream& noise) {
  std::vector<mapping::test::Wall> walls = ringWalls();
  walls.resize(20);  // without the block in its middle
  for (auto& wall : walls) wall = {{5 * wall.a.x, 5 * wall.a.y}, {5 * wall.b.x, 5 * wall.b.y}};
  lidar::Scan scan;
  scan.first_angle_rad = -core::kPi, scan.step_rad = core::kPi / 180, scan.max_range_m = 80;
  for (size_t i = 0; i < 360; ++i) {
    const double range_m = mapping::test::castRay(walls, T, scan.angle(i)) + noise.normal(0.01);
    scan.ranges_m.push_back(range_m < scan.max_range_m ? static_cast<float>(range_m) : lidar::kNoReturn);
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
