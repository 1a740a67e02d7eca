#pragma once
#include "libslam/lidar/scan.h"

namespace slam::plugin::test {

/// Beams that do not read the same; two beams without a distance do.
inline int differingReadings(const lidar::Scan& a, const lidar::Scan& b) {
  if (a.ranges_m.size() != b.ranges_m.size()) return -1;
  int differing = 0;
  for (size_t i = 0; i < a.ranges_m.size(); ++i) {
    const bool is_return = lidar::isReturn(a.ranges_m[i]);
    const bool same = is_return ? a.ranges_m[i] == b.ranges_m[i] : !lidar::isReturn(b.ranges_m[i]);
    differing += same ? 0 : 1;
  }
  return differing;
}

}  // namespace slam::plugin::test
