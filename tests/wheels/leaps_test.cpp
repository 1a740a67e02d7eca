#include "libslam/wheels/leaps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace slam::wheels {
namespace {

TEST(Leaps, AreFartherAndFasterThanTheRobotDrives) {
  Leaps leaps;
  for (int i = 0; i < 100; ++i) {
    EXPECT_FALSE(leaps.take({0.5, 0, 0.1}, 1));
    if (i % 20 == 10) {
      EXPECT_TRUE(leaps.take({30, -20, 2}, 1)) << i;
    }
  }
  EXPECT_FALSE(leaps.take({3, 0, 0}, 0.1)) << "a slip or a burst: the map tells";
  EXPECT_FALSE(leaps.take({30, 0, 0}, 60)) << "scans that are missing";
}

TEST(Leaps, AFastVehicleDoesNotLeap) {
  Leaps leaps;
  leaps.take({12, 0, 0}, 1);
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(leaps.take({12, 0, 0}, 1)) << i;
  EXPECT_TRUE(leaps.take({80, 0, 0}, 1));
}

TEST(Leaps, NoStampsNoLeap) {
  Leaps leaps;
  for (const double since_s : {0.0, -1.0, std::nan("")}) EXPECT_FALSE(leaps.take({30, 0, 0}, since_s));
  EXPECT_FALSE(leaps.take({std::nan(""), 0, 0}, 1));
  EXPECT_TRUE(leaps.take({std::numeric_limits<double>::infinity(), 0, 0}, 1));
  EXPECT_FALSE(leaps.take({0.1, 0, 0}, 1));
}

}  // namespace
}  // namespace slam::wheels
