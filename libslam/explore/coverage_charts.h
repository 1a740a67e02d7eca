#pragma once
#include <string>
#include <vector>

#include "libslam/explore/exploration_jobs.h"
#include "libslam/explore/oracle_files.h"

namespace slam::explore {

/// Explored share over time, path and scans, a line for each run and one for the oracle's tour (nullptr:
/// none).
void drawCoverage(const std::vector<ExplorationJob>& jobs, const oracle::Oracle* oracle,
                  const std::string& title, const std::string& png_path);

/// The curves of runs that leave no folder of their own.
std::string curvesCsv(const std::vector<ExplorationJob>& jobs);

}  // namespace slam::explore
