#include "@name@.h"

#include <algorithm>
#include <cmath>

using slam::goals::GoalStatus;
using slam::goals::GoalStep;

// Edit here. This one takes, of the directions in which the robot fits for two steps, the one nearest to the
// goal's: it gets round what is small, and is caught by what is hollow.
GoalStep @Name@::plan(const slam::lidar::Scan& /*scan*/, const slam::core::Pose2& T_odom_robot) {
  constexpr int kDirections = 72;
  const double to_goal = goalDirection(T_odom_robot);
  const double needed_m = std::min(2 * surroundings_.step_m(), goalDistance(T_odom_robot));
  for (int i = 0; i < kDirections; ++i) {  // 0, 5, -5, 10, -10, ... degrees from the goal's
    const double aside = (i + 1) / 2 * (i % 2 ? 1 : -1) * 2 * slam::core::kPi / kDirections;
    const double direction = slam::core::wrapToPi(to_goal + aside);
    const double free_m = surroundings_.way(direction, approachRadius(T_odom_robot)).free_m;
    if (free_m >= needed_m)
      return {surroundings_.towards(direction, std::min(free_m, goalDistance(T_odom_robot))), GoalStatus::kMoving,
              i == 0 ? "to goal" : "aside", i == 0 ? "the way is free" : "something is in the way"};
  }
  return {surroundings_.stand(), GoalStatus::kMoving, "stand", "the robot fits nowhere"};
}

slam::reach::OwnNavigator ownNavigator() {
  return {"@name@", [](const slam::goals::NavigateOptions& options, const slam::goals::GoalTask& task) {
            return std::make_unique<@Name@>(options, task);
          }};
}
