#include "libslam/lidar/mrpt_types.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CObservation2DRangeScan.h>

#include <cstring>
#include <initializer_list>

namespace slam::lidar {
namespace {

// A damaged file has any byte where a bool should be.
TEST(FromMrpt, TakesAnyByteForADirection) {
  Scan scan;
  scan.step_rad = 0.1, scan.max_range_m = 10, scan.ranges_m = {1, 2, 3};
  const auto observation = toMrpt(scan);
  for (const auto byte : std::initializer_list<unsigned char>{0, 1, 2, 255}) {
    std::memcpy(&observation->rightToLeft, &byte, 1);
    EXPECT_EQ(isRightToLeft(*observation), byte != 0) << int{byte};
    EXPECT_EQ(fromMrpt(*observation).ranges_m[0], byte != 0 ? 1 : 3) << int{byte};
  }
}

}  // namespace
}  // namespace slam::lidar
