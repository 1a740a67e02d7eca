#include "libslam/stats/proportion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/error.h"

namespace slam::stats {
namespace {

/// Chance of at most `count` of `of` at the given rate.
double binomialUpTo(std::size_t count, std::size_t of, double rate) {
  double sum = 0, ways = 1;
  for (std::size_t k = 0; k <= count; ++k) {
    sum += ways * std::pow(rate, static_cast<double>(k)) * std::pow(1 - rate, static_cast<double>(of - k));
    ways *= static_cast<double>(of - k) / static_cast<double>(k + 1);
  }
  return sum;
}

TEST(ClopperPearson, OfNoneAndOfAllIsAPowerByHand) {
  const auto none = clopperPearson(0, 10);
  EXPECT_EQ(none.low, 0);
  EXPECT_NEAR(none.high, 1 - std::pow(0.025, 0.1), 1e-12);  // 0.3085
  EXPECT_NEAR(none.high, 0.3085, 5e-5);
  const auto all = clopperPearson(10, 10);
  EXPECT_NEAR(all.low, 0.6915, 5e-5);
  EXPECT_EQ(all.high, 1);
}

TEST(ClopperPearson, LeavesHalfOfTheRestInEachTail) {
  for (const auto& [count, of] : {std::pair{3U, 10U}, {1U, 2U}, {17U, 50U}, {49U, 50U}}) {
    const auto interval = clopperPearson(count, of, 0.9);
    EXPECT_NEAR(binomialUpTo(count, of, interval.high), 0.05, 1e-9);
    EXPECT_NEAR(1 - binomialUpTo(count - 1, of, interval.low), 0.05, 1e-9);
  }
}

TEST(ClopperPearson, IsMirroredWithSuccessAndFailure) {
  const auto one = clopperPearson(3, 10), other = clopperPearson(7, 10);
  EXPECT_NEAR(one.low, 1 - other.high, 1e-12);
  EXPECT_NEAR(one.high, 1 - other.low, 1e-12);
}

TEST(ClopperPearson, KnowsNothingFromNothingAndRefusesNonsense) {
  EXPECT_EQ(clopperPearson(0, 0).low, 0);
  EXPECT_EQ(clopperPearson(0, 0).high, 1);
  EXPECT_THROW(clopperPearson(2, 1), core::ContractError);
  EXPECT_THROW(clopperPearson(1, 2, 1), core::ContractError);
  EXPECT_THROW(clopperPearson(1, 2, std::nan("")), core::ContractError);
}

}  // namespace
}  // namespace slam::stats
