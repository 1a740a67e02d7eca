#include "libslam/mapping/step_motion.h"

#include <gtest/gtest.h>

#include "tests/mapping/small_room.h"

namespace slam::mapping {
namespace {

lidar::Scan roomScan(double time_s, double mount_x_m) {
  lidar::Scan scan;
  scan.first_angle_rad = -3, scan.step_rad = 0.05, scan.max_range_m = 20;
  scan.T_robot_lidar.x = mount_x_m;
  scan.time_s = time_s;
  for (int i = 0; i < 120; ++i)
    scan.ranges_m.push_back(static_cast<float>(
        test::castRay(test::smallRoom(), scan.T_robot_lidar, scan.angle(static_cast<size_t>(i)))));
  return scan;
}

MethodOptions byScans() {
  MethodOptions method;
  method.odometry = "plicp";
  return method;
}

// The robot has gone 0.3 m since the scan of the first lidar; the next one of that lidar shows that it came
// back.
TEST(StepMotions, BetweenTwoLidarsAreCountedFromTheScanBefore) {
  StepHistory history;
  history.note(roomScan(10, 0), {}, {});
  history.note(roomScan(10.1, 0.2), {0.3, 0, 0}, {0.3, 0, 0});
  const auto motion = StepMotions(byScans(), {}, false).next(history, roomScan(10.2, 0), {}, false);
  EXPECT_NEAR(motion.T_previous_robot.x, -0.3, 1e-3);
}

TEST(StepMotions, GoOnAtTheLastSpeedUntilTheScanOfAnotherLidar) {
  StepHistory history;
  history.note(roomScan(10, 0), {}, {});
  history.note(roomScan(10.1, 0), {0.2, 0, 0}, {0.2, 0, 0});
  const auto motion = StepMotions(byScans(), {}, false).next(history, roomScan(10.3, 0.2), {}, false);
  EXPECT_NEAR(motion.T_previous_robot.x, 0.4, 1e-9);
}

}  // namespace
}  // namespace slam::mapping
