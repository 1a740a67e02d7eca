#include <gtest/gtest.h>

#include <algorithm>

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
