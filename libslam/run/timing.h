#pragma once
#include <string>
#include <vector>

#include "libslam/results/cost.h"

namespace slam::run {

/// Of the CPU times of a log's scans (ms); `more_s`: beside theirs. The factor: how much faster than the log.
results::Cost costOf(std::vector<double> milliseconds, double more_s, double log_seconds);

/// The file of them: scan, seconds since the first, ms. REQUIRES as many stamps.
std::string timingText(const std::vector<double>& milliseconds, const std::vector<double>& stamps_s);

}  // namespace slam::run
