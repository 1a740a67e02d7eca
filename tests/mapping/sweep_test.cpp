// [method] sweep_s: scans of a spinning lidar on a robot that turns.
#include <gtest/gtest.h>

#include "libslam/mapping/map_builder.h"
#include "tests/mapping/small_room.h"

namespace slam::mapping {
namespace {

/// driveThroughRoom() with exact odometry, each scan swept over the whole period before its stamp.
test::Drive sweptDrive() {
  auto drive = test::driveThroughRoom();
  const auto walls = test::smallRoom();
  const core::Pose2 T_room_start{0, 0, -0.2};
  for (size_t i = 0; i < drive.entries.size(); ++i) {
    auto& entry = drive.entries[i];
    entry.T_previous_robot = i > 0 ? core::between(drive.truth[i - 1], drive.truth[i]) : core::Pose2{};
    const core::Pose2 T_robot_previous = core::inverse(entry.T_previous_robot);
    auto& ranges_m = entry.scan.ranges_m;
    for (size_t beam = 0; beam < ranges_m.size(); ++beam) {
      const double ago = 1 - static_cast<double>(beam) / static_cast<double>(ranges_m.size() - 1);
      const core::Pose2 T_room_then =
          T_room_start * drive.truth[i] * core::interpolate({}, T_robot_previous, ago);
      ranges_m[beam] = static_cast<float>(test::castRay(walls, T_room_then, entry.scan.angle(beam)));
    }
  }
  return drive;
}

double worstHeading(double sweep_s, const test::Drive& drive) {
  core::IniFile config;
  config.set("method", "type", "graph", "test");
  config.set("method", "sweep_s", core::formatNumber(sweep_s), "test");
  auto method = makeMapBuilder(config, "graph", 1);
  double worst_rad = 0;
  for (size_t i = 0; i < drive.entries.size(); ++i) {
    const auto& entry = drive.entries[i];
    const auto pose = processScan(method, entry.scan, entry.T_previous_robot, true);
    worst_rad = std::max(worst_rad, std::abs(core::angleDifference(pose.phi, drive.truth[i].phi)));
  }
  return worst_rad;
}

TEST(Sweep, ScansAreDeskewedBeforeTheyAreMatched) {
  const auto drive = sweptDrive();
  const double as_they_are = worstHeading(0, drive), deskewed = worstHeading(0.2, drive);
  // A sweep over 0.06 rad of turning turns the scan by half of that on the mean.
  EXPECT_GT(as_they_are, 0.015);
  EXPECT_LT(deskewed, 0.005);
}

}  // namespace
}  // namespace slam::mapping
