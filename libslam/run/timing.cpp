#include "libslam/run/timing.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "libslam/files/parameters.h"

namespace slam::run {

results::Cost costOf(std::vector<double> milliseconds, double more_s, double log_seconds) {
  results::Cost cost;
  if (milliseconds.empty()) return cost;
  double total_ms = 1000 * more_s;
  for (const double ms : milliseconds) total_ms += ms;
  std::sort(milliseconds.begin(), milliseconds.end());
  const auto rank = static_cast<size_t>(std::ceil(0.99 * static_cast<double>(milliseconds.size())));
  cost.mean_ms_per_scan = total_ms / static_cast<double>(milliseconds.size());
  cost.p99_ms_per_scan = milliseconds[rank - 1];
  cost.real_time_factor = log_seconds / (total_ms / 1000);
  return cost;
}

std::string timingText(const std::vector<double>& milliseconds, const std::vector<double>& stamps_s) {
  std::ostringstream timing;
  timing << "scan,time_s,cpu_ms\n";
  for (size_t i = 0; i < milliseconds.size(); ++i)
    timing << i << ',' << files::formatNumber(stamps_s[i] - stamps_s.front()) << ','
           << files::formatNumber(milliseconds[i]) << '\n';
  return timing.str();
}

}  // namespace slam::run
