#include "libslam/goals/goal_navigator.h"

#include <cmath>

#include "libslam/core/error.h"
#include "libslam/goals/bug1.h"
#include "libslam/goals/bug2.h"
#include "libslam/goals/lidar_bug.h"
#include "libslam/goals/tangent_bug.h"
#include "libslam/safety/obstacle_memory.h"

namespace slam::goals {
namespace {

using Maker = std::unique_ptr<GoalNavigator> (*)(const NavigateOptions&, const GoalTask&);

template <class N>
std::unique_ptr<GoalNavigator> make(const NavigateOptions& options, const GoalTask& task) {
  return std::make_unique<N>(options, task);
}

struct Entry {
  const char* name;
  const char* meaning;
  Maker maker;
};
constexpr Entry kNavigators[] = {
    {"bug1", "round every obstacle that it hits, then on from where it came nearest to the goal", make<Bug1>},
    {"bug2", "along an obstacle until the line from start to goal is met again", make<Bug2>},
    {"tangent", "TangentBug: towards what the lidar sees free; along a boundary only out of a local minimum",
     make<TangentBug>},
    {"lidar_bug", "the original state machine on five directions of the lidar; no guarantee",
     make<LidarBug>}};

}  // namespace

const char* statusName(GoalStatus status) {
  static constexpr const char* kNames[] = {"moving", "reached", "unreachable", "gave up"};
  return kNames[static_cast<int>(status)];
}

const files::ParameterTable<NavigateOptions>& NavigateOptions::table() {
  using O = NavigateOptions;
  static const files::ParameterTable<O> rows(
      "navigate",
      {{"goal_tolerance_m", &O::goal_tolerance_m, 0.1, 0.01, 10.0, "nearer to the goal counts as there"},
       {"clearance_m", &O::clearance_m, 0.05, 0.0, 1.0,
        "room kept around the robot's circle besides 2 cm and one standard deviation of the range"},
       {"boundary_tolerance_m", &O::boundary_tolerance_m, 0.2, 0.05, 5.0,
        "nearer to where following a boundary began counts as having been round it"},
       {"time_limit_s", &O::time_limit_s, 1800.0, 1.0, 1e6, "then it gives up; of the robot's time"},
       {"turn", &O::turn, "left", {"left", "right"}, "at an obstacle; bug1 and bug2"},
       {"sensor_range_m", &O::sensor_range_m, 0.0, 0.0, 1e4,
        "how far tangent believes the lidar; 0 is the lidar's own range"},
       {"memory", &O::memory, "short", safety::obstacleMemoryNames(),
        "of obstacles that the newest scan does not show: none, within 1.5 m, or the local map of "
        "[obstacles]"},
       {"unseen",
        &O::unseen,
        "free",
        {"free", "looked_at"},
        "floor that the sensor has not shown: free, or turned to and looked at before it is driven on"}});
  return rows;
}

NavigateOptions::NavigateOptions() {
  table().setDefaults(*this);
}

const files::ParameterTable<LidarBugOptions>& LidarBugOptions::table() {
  using O = LidarBugOptions;
  static const files::ParameterTable<O> rows(
      "lidar_bug",
      {{"stop_radius_m", &O::stop_radius_m, 0.22, 0.0, 10.0,
        "a reading below is a bump; at least what the robot's circle needs"},
       {"invalid_below_m", &O::invalid_below_m, 0.01, 0.0, 1.0, "readings below are invalid"},
       {"obstacle_range_m", &O::obstacle_range_m, 0.6, 0.01, 10.0, "an obstacle ahead within it is avoided"},
       {"side_range_m", &O::side_range_m, 0.4, 0.01, 10.0, "an obstacle to the side within it is avoided"},
       {"clear_front_m", &O::clear_front_m, 0.8, 0.01, 10.0,
        "the front is clear when readings ahead are at least this; half as much again after several bumps"},
       {"wall_distance_m", &O::wall_distance_m, 0.5, 0.01, 10.0, "kept from the wall that is followed"},
       {"wall_lost_m", &O::wall_lost_m, 1.0, 0.01, 10.0, "nothing nearer on either side: the wall has ended"},
       {"drive_on_m", &O::drive_on_m, 0.4, 0.01, 10.0, "driven on after turning to a clear front"},
       {"back_off_m", &O::back_off_m, 0.15, 0.01, 10.0, "driven away from a bump"},
       {"stuck_turn_deg", &O::stuck_turn_rad, 45.0, 1.0, 180.0, "turned away from a bump"},
       {"near_goal_m", &O::near_goal_m, 0.8, 0.01, 10.0, "nearer it drives at the goal"},
       {"off_course_deg", &O::off_course_rad, 15.0, 1.0, 180.0, "beyond it turns to the goal again"},
       {"bumps_in_a_row", &O::bumps_in_a_row, 3, 1, 1000, "then it turns until the front is clear"},
       {"wall_end",
        &O::wall_end,
        "goal",
        {"goal", "front"},
        "where the wall ends it turns until: the goal's side is clear, or, as the original, the front is"}});
  return rows;
}

LidarBugOptions::LidarBugOptions() {
  table().setDefaults(*this);
}

std::vector<std::string> goalNavigatorNames() {
  std::vector<std::string> names;
  for (const auto& entry : kNavigators) names.push_back(entry.name);
  return names;
}

std::string goalNavigatorMeaning(const std::string& name) {
  for (const auto& entry : kNavigators)
    if (name == entry.name) return entry.meaning;
  throw core::ContractError("goalNavigatorMeaning: no method '" + name + "'");
}

std::unique_ptr<GoalNavigator> makeGoalNavigator(const std::string& name, const NavigateOptions& options,
                                                 const GoalTask& task) {
  if (!std::isfinite(task.p_odom_goal.x) || !std::isfinite(task.p_odom_goal.y))
    throw core::ContractError("makeGoalNavigator: expected a finite goal");
  if (!(task.period_s > 0) || !std::isfinite(task.period_s))
    throw core::ContractError("makeGoalNavigator: expected a positive period");
  for (const auto& entry : kNavigators)
    if (name == entry.name) return entry.maker(options, task);
  std::string known;
  for (const auto& entry : kNavigators) known += (known.empty() ? "" : ", ") + std::string(entry.name);
  throw core::InputError("method of navigation: found '" + name + "', expected one of " + known +
                         core::didYouMean(name, goalNavigatorNames()));
}

}  // namespace slam::goals
