#include "libslam/reach/goal_methods.h"

#include <algorithm>

#include "libslam/core/error.h"
#include "libslam/goals/lidar_bug.h"
#include "libslam/goals/surroundings.h"

namespace slam::reach {
namespace {
const std::string kMrptReactive = "mrpt_reactive";
}

std::vector<std::string> goalMethodNames() {
  auto names = goals::goalNavigatorNames();
  if (mrptnav::reactiveNavigationAvailable()) names.push_back(kMrptReactive);
  return names;
}

std::string goalMethodMeaning(const std::string& name) {
  if (name == kMrptReactive) return "MRPT's own CReactiveNavigationSystem; no guarantee";
  return goals::goalNavigatorMeaning(name);
}

void requireGoalMethod(const std::string& name) {
  const auto names = goalMethodNames();
  if (std::find(names.begin(), names.end(), name) != names.end()) return;
  std::string known;
  for (const auto& other : names) known += (known.empty() ? "" : ", ") + other;
  throw core::InputError("method of navigation: found '" + name + "', expected one of " + known +
                         core::didYouMean(name, names));
}

std::unique_ptr<goals::GoalNavigator> makeGoalMethod(const std::string& name,
                                                     const goals::NavigateOptions& options,
                                                     const mrptnav::ReactiveOptions& mrpt_reactive,
                                                     const goals::GoalTask& task) {
  requireGoalMethod(name);
  if (name == kMrptReactive) return mrptnav::makeReactiveNavigator(mrpt_reactive, options, task);
  return goals::makeGoalNavigator(name, options, task);
}

std::optional<StrategicOverlay> strategicOverlay(const std::string& method,
                                                 const goals::NavigateOptions& options,
                                                 const robot::RobotOptions& robot,
                                                 const lidar::LidarOptions& lidar) {
  if (method != "lidar_bug") return std::nullopt;
  const goals::Surroundings surroundings(robot, options.clearance_m, 1 / lidar.rate_hz);
  const double guard_m = surroundings.guardRadius() + lidar.sigma_m;
  const auto directions = goals::strategicDirections();
  return StrategicOverlay{goals::lidarBugStopRadius(options.lidar_bug, guard_m),
                          {directions.begin(), directions.end()}};
}

}  // namespace slam::reach
