#pragma once
#include <cstdlib>
#include <fstream>
#include <limits>
#include <string>

namespace slam::process {

/// A figure of /proc/self/status ("VmRSS", "VmHWM", "VmData") in MB; NaN where the system has none.
inline double processMemoryMb(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.compare(0, key.size() + 1, key + ":") == 0)
      return std::atof(line.c_str() + key.size() + 1) / 1024;
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace slam::process
