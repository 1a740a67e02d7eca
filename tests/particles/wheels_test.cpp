#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "libslam/core/elementary.h"
#include "libslam/particles/particle_filter.h"
#include "tests/mapping/small_room.h"
#include "tests/particles/ring.h"

namespace slam::particles {
namespace {

using namespace ring_drive;

long count(const ParticleFilter& filter, core::JournalEvent event) {
  return std::count_if(filter.journal().begin(), filter.journal().end(),
                       [&](const core::JournalEntry& entry) { return entry.event == event; });
}

double errorAt(const ParticleFilter& filter, size_t scan) {
  return core::distance(filter.lastStep().T_map_robot, ring().truth[scan]);
}

// A counter that begins anew once took the robot to where nothing was mapped, and its map with it.
TEST(ParticleWheels, ALeapIsNoMotion) {
  ParticleFilter filter(options(), 1);
  run(filter, 50);
  filter.update(ring().scans[50], motionOf({-31, 7, 2}));
  EXPECT_LT(errorAt(filter, 50), 0.1);
  for (size_t i = 51; i < 60; ++i) filter.update(ring().scans[i], motionOf(ring().wheels[i]));
  EXPECT_LT(errorAt(filter, 59), 0.1);
  EXPECT_EQ(count(filter, core::JournalEvent::kLeapt), 1);
  EXPECT_EQ(count(filter, core::JournalEvent::kLost), 0);
}

TEST(ParticleWheels, ZerosAreNoOdometry) {
  ParticleFilter filter(options(), 1);
  // 0.6 m between scans: wheels that stand would hold the robot.
  const auto drive = mapping::test::driveThroughRoom();
  for (size_t i = 0; i < drive.entries.size(); i += 10) {
    filter.update(drive.entries[i].scan, motionOf({}));
    EXPECT_LT(core::distance(filter.lastStep().T_map_robot, drive.truth[i]), 0.06) << i;
  }
  EXPECT_EQ(count(filter, core::JournalEvent::kSilent), 1);
}

TEST(ParticleWheels, MetresBackwardsMayBeCountedForwards) {
  constexpr double kTurn_rad = 0.25;  // as it was: this is no motion run backwards
  ParticleFilter filter(options(), 1);
  core::Pose2 T{0, 0, -0.2};
  filter.update(mapping::test::scanRoom(T, 1.6e9), std::nullopt);
  const core::Pose2 T_room_start = T;
  for (int i = 1; i <= 8; ++i) {
    const double way_m = i <= 4 ? 0.4 : -0.4;
    T = T * core::Pose2{way_m, 0, kTurn_rad};
    filter.update(mapping::test::scanRoom(T, 1.6e9 + i), motionOf({0.4, 0, kTurn_rad}));
    EXPECT_LT(core::distance(filter.lastStep().T_map_robot, core::between(T_room_start, T)), 0.05) << i;
  }
}

/// What the robot drives straight ahead from scan to scan, which the wheels tell, and what they turn by where
/// it does not.
struct Step {
  double way_m, wrong_rad;
};

/// Along a clean corridor whose walls are in sight for 30 m; where it is in the end.
core::Pose2 driveCorridor(ParticleFilter& filter, const std::vector<Step>& steps) {
  const std::vector<mapping::test::Wall> walls = {{{-100, -1}, {200, -1}}, {{-100, 1}, {200, 1}}};
  core::Pose2 T;
  for (size_t i = 0; i < steps.size(); ++i) {
    if (i > 0) T.x += steps[i].way_m;
    lidar::Scan scan;
    scan.time_s = static_cast<double>(i), scan.max_range_m = 30;
    scan.first_angle_rad = -core::kPi / 2, scan.step_rad = core::kPi / 360;
    for (size_t k = 0; k < 361; ++k) {
      const double range_m = mapping::test::castRay(walls, T, scan.angle(k));
      scan.ranges_m.push_back(range_m < 30 ? static_cast<float>(range_m) : lidar::kNoReturn);
    }
    filter.update(scan, motionOf({steps[i].way_m, 0, steps[i].wrong_rad}));
  }
  return T;
}

// Turned by two degrees a scan is explained by three quarters; what went on then was the motion before, for
// all three coordinates, and along the corridor nothing told that it was wrong.
TEST(ParticleWheels, AreDoubtedForNoTurnThatTheyAllowThemselves) {
  std::vector<Step> steps;
  for (int i = 0; i < 60; ++i) steps.push_back({0.4, i % 3 == 0 ? 0.06 : -0.04});
  ParticleFilter filter(options(), 1);
  const core::Pose2 truth = driveCorridor(filter, steps);
  EXPECT_EQ(count(filter, core::JournalEvent::kDistrusted), 0);
  EXPECT_NEAR(filter.lastStep().T_map_robot.x, truth.x, 0.2);
  EXPECT_NEAR(filter.lastStep().T_map_robot.y, 0, 0.05);
}

TEST(ParticleWheels, AreDoubtedForTheTurnAloneThatIsWrong) {
  std::vector<Step> steps(40, {0.4, 0});
  steps.push_back({0.1, 0.3});
  ParticleFilter filter(options(), 1);
  const core::Pose2 truth = driveCorridor(filter, steps);
  EXPECT_TRUE(filter.lastStep().odometry_distrusted);
  EXPECT_NEAR(filter.lastStep().T_map_robot.x, truth.x, 0.15);
  EXPECT_NEAR(filter.lastStep().T_map_robot.phi, 0, 0.01);
}

// A narrow lidar that turns sees new things for the most part, which once was taken for a robot that is lost;
// no scan entered the map any more.
TEST(ParticleFilter, NewGroundContradictsNoPose) {
  ParticleFilter filter(options(), 1);
  core::Pose2 T{0, 0, -0.2};
  for (int i = 0; i < 6; ++i) {
    const core::Pose2 turn{0, 0, i == 0 ? 0 : core::degToRad(64)};
    T = T * turn;
    filter.update(mapping::test::scanRoom(T, 1.6e9 + i, 91, 90), motionOf(turn));
    EXPECT_FALSE(filter.lastStep().lost) << i;
    EXPECT_TRUE(filter.lastStep().inserted) << i;
  }
  EXPECT_LT(core::hypot(filter.lastStep().T_map_robot.x, filter.lastStep().T_map_robot.y), 0.1);
}

}  // namespace
}  // namespace slam::particles
