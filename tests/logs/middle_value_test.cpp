#include "libslam/logs/middle_value.h"

#include <gtest/gtest.h>

namespace slam::logs {
namespace {

TEST(MiddleValue, IsTheUpperOfTwoAndNothingsIsZero) {
  EXPECT_EQ(middleValue({}), 0);
  EXPECT_EQ(middleValue({5}), 5);
  EXPECT_EQ(middleValue({7, 1}), 7);
  EXPECT_EQ(middleValue({9, 1, 4}), 4);
}

}  // namespace
}  // namespace slam::logs
