#pragma once
#include <string>
#include <vector>

#include "libslam/results/cost.h"

namespace slam::run {

/// Of the CPU times of a log's scans; `more_s`: CPU time beside theirs. Without scans zeros, and no memory in
/// any case.
results::Cost costOf(std::vector<double> milliseconds, double more_s, double log_seconds);

/// The file of them: scan, seconds since the first, ms. REQUIRES as many stamps.
std::string timingText(const std::vector<double>& milliseconds, const std::vector<double>& stamps_s);

}  // namespace slam::run
