#pragma once
#include <string>

#include "libslam/summary/run_figures.h"
#include "libslam/sweep/sweep_plan.h"

namespace slam::summary {

/// Writes an SQLite database of a sweep, for questions that no table answers:
///   logs(id, world, robot, lidar, odometry, strategy, fault, seed)
///   runs(id, log, seed, method, parameters, status, message, folder)
///   figures(run, key, value)
/// It is made anew every time and nothing is ever read from it. Errors: IoError with the path.
void writeSweepIndex(const sweep::SweepPlan& plan, const SweepResults& results, const std::string& path);

}  // namespace slam::summary
