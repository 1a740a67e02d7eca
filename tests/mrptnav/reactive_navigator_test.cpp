#include "libslam/mrptnav/reactive_navigator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/sim/simulator.h"
#include "libslam/testing/temp_folder.h"
#include "libslam/world/plan.h"

namespace slam::mrptnav {
namespace {

using navigate::GoalStatus;
using world::Cell;
using world::Plan;

/// width x height metres of free floor at 0.05 m, walls two cells thick all round.
Plan room(double width_m, double height_m) {
  Plan plan;
  plan.name = "room";
  plan.columns = static_cast<int>(std::lround(width_m / plan.resolution_m)) + 4;
  plan.rows = static_cast<int>(std::lround(height_m / plan.resolution_m)) + 4;
  plan.T_world_plan = {-2 * plan.resolution_m, -2 * plan.resolution_m, 0};
  plan.cells.assign(static_cast<size_t>(plan.columns) * plan.rows, Cell::kOccupied);
  for (int row = 2; row < plan.rows - 2; ++row)
    for (int column = 2; column < plan.columns - 2; ++column)
      plan.cells[static_cast<size_t>(row) * plan.columns + column] = Cell::kFree;
  return plan;
}

void wall(Plan& plan, double x0, double y0, double x1, double y1) {
  const auto low = world::worldToCells(plan, {x0, y0}), high = world::worldToCells(plan, {x1, y1});
  for (long row = std::lround(low.y); row < std::lround(high.y); ++row)
    for (long column = std::lround(low.x); column < std::lround(high.x); ++column)
      plan.cells[static_cast<size_t>(row) * plan.columns + column] = Cell::kOccupied;
}

struct Drive {
  navigate::GoalStep end;
  core::Trajectory truth;
  size_t collisions = 0;
  double off_goal_m = 0;
};

Drive drive(const Plan& plan, const core::Pose2& start, const core::Point2& p_world_goal, std::uint64_t seed,
            double fov_deg = 360, double time_limit_s = 300) {
  robot::LidarOptions lidar;
  lidar.fov_rad = core::degToRad(fov_deg);
  lidar.beams = 361;
  lidar.max_range_m = 12;
  navigate::NavigateOptions limits;
  limits.time_limit_s = time_limit_s;
  navigate::GoalTask task;
  task.p_odom_goal = core::inverse(start) * p_world_goal;
  task.period_s = 1 / lidar.rate_hz;
  sim::Simulator simulator(plan, task.robot, lidar, {}, start, seed);
  const auto navigator = makeReactiveNavigator({}, limits, task);
  Drive drive;
  for (sim::Sensed sensed = simulator.sense();;) {
    drive.truth.push_back({simulator.time_s(), simulator.truth()});
    drive.end = navigator->next(sensed.scan, sensed.T_odom_robot, sensed.collided);
    if (std::getenv("TRACE")) std::printf("%.2f %.3f %.3f %.2f  v %.3f w %.3f %s\n", simulator.time_s()-1.7e9, simulator.truth().x, simulator.truth().y, simulator.truth().phi, drive.end.command.speed_mps, drive.end.command.turn_rate_radps, drive.end.reason.c_str());
    if (drive.end.status != GoalStatus::kMoving) break;
    sensed = simulator.step(drive.end.command);
  }
  drive.collisions = simulator.collisions().size();
  drive.off_goal_m = core::distance(core::position(simulator.truth()), p_world_goal);
  std::printf("%s (%s): %zu steps, %.2f m, %.2f off, %zu collisions\n", navigate::statusName(drive.end.status), drive.end.reason.c_str(), drive.truth.size(), core::pathLength(drive.truth), drive.off_goal_m, drive.collisions);
  return drive;
}

TEST(ReactiveNavigator, DrivesRoundAnObstacleToTheGoal) {
  Plan plan = room(8, 6);
  wall(plan, 3.5, 2.2, 4.0, 4.0);
  drive(plan, {1.5, 3, 0}, {6.5, 3}, 1);
  drive(plan, {1.5, 3, 3.0}, {6.5, 3}, 1);
  drive(plan, {1.5, 3, 0}, {6.5, 3}, 1, 270);
}

TEST(ReactiveNavigator, CrossesTheHallOfPillars) {
  const Plan plan = world::loadPlan(std::string(RASTERSLAM_SOURCE_DIR) + "/datasets/worlds/pillar_hall.yaml");
  const auto start = world::findStartPose(plan, 0.5);
  std::printf("%f %f; %d x %d\n", start->x, start->y, plan.columns, plan.rows);
  drive(plan, *start, {start->x + 6, start->y + 4}, 1);
  drive(plan, *start, {start->x - 6, start->y - 3}, 2, 270);
}

}  // namespace
}  // namespace slam::mrptnav
