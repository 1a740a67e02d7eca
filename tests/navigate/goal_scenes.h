#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libslam/goals/goal_navigator.h"
#include "libslam/sim/simulator.h"
#include "libslam/world/plan.h"

namespace slam::navigate::scenes {

/// Wheels that report what they did.
robot::OdometryOptions exactOdometry();
/// A full circle of one-degree beams without noise.
lidar::LidarOptions exactLidar(double max_range_m = 6);

/// A drive to a goal.
struct GoalDrive {
  goals::GoalStatus status = goals::GoalStatus::kMoving;
  std::string reason;
  std::vector<std::string> states;  ///< in the order in which they were entered
  core::Trajectory truth;
  core::Point2 end;
  double path_m = 0, goal_distance_m = 0;  ///< true ones
  size_t collisions = 0;
};

struct GoalScene {
  world::Plan plan;
  core::Pose2 start;
  core::Point2 goal;
};

GoalDrive driveTo(const GoalScene& scene, const std::string& method, const lidar::LidarOptions& lidar,
                  const robot::OdometryOptions& odometry, const goals::NavigateOptions& options = {},
                  std::uint64_t seed = 1, const std::optional<robot::FloorCamera>& camera = std::nullopt);
/// The same with the default floor camera in place of a lidar and exact wheels.
GoalDrive driveByCamera(const GoalScene& scene, const std::string& method,
                        const goals::NavigateOptions& options, std::uint64_t seed = 1);

// Drawn places, 8 x 8 m and smaller. The goal can be reached in the first group and cannot in the second.
GoalScene openRoom();
GoalScene pillar();   ///< one block across the way
GoalScene trap();     ///< a U that opens towards the start
GoalScene spiral();   ///< the goal in the middle of a spiral
GoalScene doors();    ///< two thin walls with a door each, on opposite sides
GoalScene comb();     ///< a block with dead ends that are too narrow in part
GoalScene pillars();  ///< three blocks of which the line cuts two
std::vector<std::pair<std::string, GoalScene>> reachableScenes();

GoalScene goalInBox();   ///< walls all round the goal
GoalScene startInBox();  ///< walls all round the start
GoalScene narrowDoor();  ///< the only door is narrower than the robot
GoalScene goalInWall();
std::vector<std::pair<std::string, GoalScene>> unreachableScenes();

}  // namespace slam::navigate::scenes
