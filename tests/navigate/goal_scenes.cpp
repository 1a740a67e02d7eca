#include "tests/navigate/goal_scenes.h"

#include "tests/navigate/scenes.h"

namespace slam::navigate::scenes {

using world::Cell;

robot::OdometryOptions exactOdometry() {
  robot::OdometryOptions odometry;
  odometry.alpha1 = odometry.alpha2 = odometry.alpha3 = odometry.alpha4 = 0;
  odometry.scale = 1;
  odometry.heading_bias_radpm = 0;
  return odometry;
}

lidar::LidarOptions exactLidar(double max_range_m) {
  lidar::LidarOptions lidar = circleLidar();
  lidar.max_range_m = max_range_m;
  lidar.sigma_m = 0;
  return lidar;
}

GoalDrive driveTo(const GoalScene& scene, const std::string& method, const lidar::LidarOptions& lidar,
                  const robot::OdometryOptions& odometry, const goals::NavigateOptions& options,
                  std::uint64_t seed, const std::optional<robot::FloorCamera>& camera) {
  const robot::RobotOptions robot;
  const double period_s = 1 / lidar.rate_hz;
  sim::Simulator simulator(scene.plan, robot, lidar, odometry, scene.start, seed,
                           sim::Simulator::kStartTime_s, {}, camera);
  const core::Point2 p_odom_goal = core::inverse(scene.start) * scene.goal;
  const auto navigator = goals::makeGoalNavigator(method, options, {p_odom_goal, robot, period_s});
  GoalDrive drive;
  sim::Sensed sensed = simulator.sense();
  while (true) {
    drive.truth.push_back({simulator.time_s(), simulator.truth()});
    const goals::GoalStep step = navigator->next(sensed.scan, sensed.T_odom_robot, sensed.collided);
    if (drive.states.empty() || drive.states.back() != step.state) drive.states.push_back(step.state);
    drive.status = step.status;
    drive.reason = step.reason;
    if (step.status != goals::GoalStatus::kMoving) break;
    sensed = simulator.step(step.command);
  }
  drive.end = core::position(simulator.truth());
  drive.path_m = core::pathLength(drive.truth);
  drive.goal_distance_m = core::distance(drive.end, scene.goal);
  drive.collisions = simulator.collisions().size();
  return drive;
}

GoalDrive driveByCamera(const GoalScene& scene, const std::string& method,
                        const goals::NavigateOptions& options, std::uint64_t seed) {
  const robot::FloorCamera camera;
  return driveTo(scene, method, robot::asLidar(camera), exactOdometry(), options, seed, camera);
}

GoalScene openRoom() {
  return {room(6, 4), {1, 2, 2.0}, {5, 2.3}};
}

GoalScene pillar() {
  GoalScene scene{room(7, 5), {1, 2.5, 0}, {6, 2.5}};
  fill(scene.plan, 3, 1.8, 3.8, 3.0);
  return scene;
}

GoalScene trap() {
  GoalScene scene{room(8, 6), {1, 3, 0}, {7, 3}};
  fill(scene.plan, 2.5, 1.2, 5.0, 1.3);
  fill(scene.plan, 2.5, 4.5, 5.0, 4.6);
  fill(scene.plan, 4.9, 1.2, 5.0, 4.6);
  return scene;
}

GoalScene spiral() {
  GoalScene scene{room(7, 7), {0.6, 0.6, 0}, {3.5, 3.45}};
  auto& plan = scene.plan;
  fill(plan, 1.2, 1.2, 5.8, 1.3);  // below, open at the left end of the outer turn
  fill(plan, 5.7, 1.2, 5.8, 5.8);  // right
  fill(plan, 1.2, 5.7, 5.8, 5.8);  // above
  fill(plan, 1.2, 2.4, 1.3, 5.8);  // left: the way in is between y = 1.3 and 2.4
  fill(plan, 1.2, 2.4, 4.6, 2.5);  // the second turn
  fill(plan, 4.5, 2.4, 4.6, 4.6);
  fill(plan, 2.4, 4.5, 4.6, 4.6);
  return scene;
}

GoalScene doors() {
  GoalScene scene{room(8, 5), {1, 2.5, 1}, {7, 2.5}};
  fill(scene.plan, 3.0, 0, 3.05, 5);
  fill(scene.plan, 3.0, 0.2, 3.05, 1.1, Cell::kFree);
  fill(scene.plan, 5.0, 0, 5.05, 5);
  fill(scene.plan, 5.0, 3.9, 5.05, 4.8, Cell::kFree);
  return scene;
}

GoalScene comb() {
  GoalScene scene{room(8, 6), {1, 3, 0}, {7, 3}};
  for (const double y : {1.0, 1.7, 2.8, 3.3, 4.3, 4.8}) fill(scene.plan, 3, y, 5, y + 0.1);
  fill(scene.plan, 4.9, 1.0, 5.0, 4.9);
  return scene;
}

GoalScene pillars() {
  GoalScene scene{room(9, 6), {1, 3, 0}, {8, 3}};
  fill(scene.plan, 2.5, 2.2, 3.2, 3.4);
  fill(scene.plan, 5.0, 2.6, 6.2, 4.0);
  fill(scene.plan, 4.0, 0.9, 4.6, 1.3);
  return scene;
}

std::vector<std::pair<std::string, GoalScene>> reachableScenes() {
  return {{"open room", openRoom()}, {"pillar", pillar()}, {"trap", trap()},      {"spiral", spiral()},
          {"doors", doors()},        {"comb", comb()},     {"pillars", pillars()}};
}

GoalScene goalInBox() {
  GoalScene scene{room(7, 5), {1, 2.5, 0}, {4.5, 2.5}};
  fill(scene.plan, 3.6, 1.6, 5.4, 3.4);
  fill(scene.plan, 3.7, 1.7, 5.3, 3.3, Cell::kFree);
  return scene;
}

GoalScene startInBox() {
  GoalScene scene = goalInBox();
  std::swap(scene.start.x, scene.goal.x);
  std::swap(scene.start.y, scene.goal.y);
  return scene;
}

GoalScene narrowDoor() {
  GoalScene scene{room(6, 4), {1, 2, 0}, {5, 2}};
  fill(scene.plan, 3.0, 0, 3.1, 4);
  fill(scene.plan, 3.0, 1.75, 3.1, 2.25, Cell::kFree);
  return scene;
}

GoalScene goalInWall() {
  GoalScene scene = pillar();
  scene.goal = {3.4, 2.4};
  return scene;
}

std::vector<std::pair<std::string, GoalScene>> unreachableScenes() {
  return {{"goal in a box", goalInBox()},
          {"start in a box", startInBox()},
          {"narrow door", narrowDoor()},
          {"goal in a wall", goalInWall()}};
}

}  // namespace slam::navigate::scenes
