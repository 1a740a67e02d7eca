#pragma once
#include <string>
#include <vector>

#include "libslam/reach/reach_goal.h"

namespace slam::reach {

/// The true path of one drive on the plan, coloured by the method's states, with the goal; of `lidar_bug`
/// also the stop radius, dashed, and the strategic directions, as they lay where it first met an obstacle, or
/// where it began. Errors: IoError.
void drawGoalRun(const ReachGoalRequest& request, const GoalRun& run, const std::string& title,
                 const std::string& path);

/// The true paths of all of them. Errors: IoError.
void drawGoalRuns(const ReachGoalRequest& request, const std::vector<GoalRun>& runs, const std::string& path);

}  // namespace slam::reach
