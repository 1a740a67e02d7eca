#include "libslam/sim/camera_sensor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/error.h"
#include "libslam/rays/ray_caster.h"
#include "libslam/sim/simulator.h"
#include "tests/world/drawn_plan.h"

namespace slam::sim {
namespace {

using core::degToRad;
using core::Pose2;

robot::FloorCamera exactCamera() {
  robot::FloorCamera camera;
  camera.scan.edge_sigma_rad = 0;
  return camera;
}

/// 8 m by 8 m, a wall all round, a post of 0.5 m.
world::Plan room() {
  std::vector<std::string> lines(16, "#..............#");
  lines.front() = lines.back() = "################";
  lines[8][10] = '#';  // x 5 .. 5.5, y 3.5 .. 4
  return world::drawnPlan(lines, 0.5);
}

lidar::Scan look(const robot::FloorCamera& camera, const Pose2& T_world_robot) {
  const auto plan = room();
  const movers::Scene scene(plan);
  return CameraSensor(camera, 1).sense(scene, T_world_robot, 7);
}

TEST(CameraSensors, SeeTheFootOfAnObstacleWhereItStands) {
  const auto scan = look(exactCamera(), {3, 3.75, 0});
  const size_t middle = scan.ranges_m.size() / 2;
  EXPECT_NEAR(scan.angle(middle), 0, 1e-12);
  EXPECT_NEAR(scan.ranges_m[middle], 1.9, 1e-6) << "the post's face at x = 5, the camera's foot at 3.1";
  EXPECT_EQ(scan.time_s, 7);
  EXPECT_EQ(scan.T_robot_lidar.x, 0.1);
  EXPECT_EQ(scan.max_range_m, 4);
}

TEST(CameraSensors, SayWhereTheFloorIsFreeAndNothingOfTheDeadZone) {
  const auto away = look(exactCamera(), {2, 6, 0});
  EXPECT_EQ(away.ranges_m[away.ranges_m.size() / 2], lidar::kNoReturn) << "the wall is 5.4 m away";
  // The wall's face 0.4 m before the camera's foot, the floor is seen from 0.458 m on: the wall hides all of
  // it.
  const auto close = look(exactCamera(), {7.0, 6, 0});
  for (const float range_m : close.ranges_m) EXPECT_FALSE(lidar::isReturn(range_m) && range_m < 0.458);
  EXPECT_TRUE(std::isnan(close.ranges_m[close.ranges_m.size() / 2]));
}

TEST(CameraSensors, SeeOfEveryBearingWhatTheExactRayMeetsInTheVisibleFloor) {
  const auto camera = exactCamera();
  const auto plan = room();
  for (const Pose2 T_world_robot :
       {Pose2{3, 3.75, 0.3}, Pose2{4, 2, 2.5}, Pose2{6.2, 5, -1}, Pose2{2, 6, 1.5}}) {
    const auto scan = look(camera, T_world_robot);
    const Pose2 T_world_camera = T_world_robot * scan.T_robot_lidar;
    for (size_t i = 0; i < scan.ranges_m.size(); ++i) {
      const double exact_m =
          rays::castRay(plan, core::position(T_world_camera), T_world_camera.phi + scan.angle(i), 0);
      const auto span = robot::bearingSpan(camera, scan.angle(i));
      const bool is_seen = exact_m > span.begin_m && exact_m < span.end_m;
      EXPECT_EQ(lidar::isReturn(scan.ranges_m[i]), is_seen) << i;
      EXPECT_NEAR(is_seen ? scan.ranges_m[i] - exact_m : 0, 0, 1e-5) << i;
    }
  }
}

TEST(CameraSensors, TakeTheLidarsPlaceInTheSimulator) {
  const auto plan = room();
  const auto camera = exactCamera();
  Simulator simulator(plan, {}, robot::asLidar(camera), {}, {3, 3.75, 0}, 1, Simulator::kStartTime_s, {},
                      camera);
  const auto sensed = simulator.step({0.5, 0, 0.2});
  EXPECT_NEAR(sensed.scan.ranges_m[sensed.scan.ranges_m.size() / 2], 1.8, 1e-6);
}

TEST(CameraSensors, AreTheSameForTheSameSeed) {
  robot::FloorCamera camera;
  const auto a = look(camera, {3, 3.75, 0}), b = look(camera, {3, 3.75, 0});
  for (size_t i = 0; i < a.ranges_m.size(); ++i)
    EXPECT_TRUE(a.ranges_m[i] == b.ranges_m[i] || (std::isnan(a.ranges_m[i]) && std::isnan(b.ranges_m[i])));
  camera.view.pitch_rad = degToRad(-60);
  EXPECT_THROW(CameraSensor(camera, 1), core::InputError);
}

}  // namespace
}  // namespace slam::sim
