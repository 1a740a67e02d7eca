#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libslam/goals/goal_navigator.h"
#include "libslam/lidar/lidar.h"
#include "libslam/mrptnav/reactive_navigator.h"
#include "libslam/robot/drive.h"

namespace slam::reach {

/// Every method that drives to a goal: those of room goals, then mrpt_reactive where the program was built
/// with MRPT's module nav.
std::vector<std::string> goalMethodNames();
/// One line for lists. REQUIRES a name of goalMethodNames() (ContractError).
std::string goalMethodMeaning(const std::string& name);
/// InputError with the nearest known name.
void requireGoalMethod(const std::string& name);
/// Errors: as requireGoalMethod(), goals::makeGoalNavigator() and mrptnav::makeReactiveNavigator().
std::unique_ptr<goals::GoalNavigator> makeGoalMethod(const std::string& name,
                                                     const goals::NavigateOptions& options,
                                                     const mrptnav::ReactiveOptions& mrpt_reactive,
                                                     const goals::GoalTask& task);

/// What the original `lidar_bug` looks at, for pictures, robot frame.
struct StrategicOverlay {
  double stop_radius_m;
  std::vector<double> directions_rad;
};
/// nullopt for the other methods.
std::optional<StrategicOverlay> strategicOverlay(const std::string& method,
                                                 const goals::NavigateOptions& options,
                                                 const robot::RobotOptions& robot,
                                                 const lidar::LidarOptions& lidar);

}  // namespace slam::reach
