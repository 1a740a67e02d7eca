#include "libslam/core/middle_value.h"

#include <gtest/gtest.h>

namespace slam::core {
namespace {

TEST(MiddleValue, IsTheUpperOfTwoAndNothingsIsZero) {
  EXPECT_EQ(middleValue(std::vector<double>{}), 0);
  EXPECT_EQ(middleValue(std::vector<double>{5}), 5);
  EXPECT_EQ(middleValue(std::vector<int>{7, 1}), 7);
  EXPECT_EQ(middleValue(std::vector<float>{9, 1, 4}), 4);
}

TEST(ValueOfRank, CountsFromTheSmallest) {
  for (std::size_t rank = 0; rank < 5; ++rank) {
    std::vector<int> values = {3, 0, 4, 1, 2};
    EXPECT_EQ(valueOfRank(values, rank), static_cast<int>(rank));
  }
  std::vector<int> equal = {2, 2, 1};
  EXPECT_EQ(valueOfRank(equal, 1), 2);
}

}  // namespace
}  // namespace slam::core
