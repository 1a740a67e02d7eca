#include "libslam/stats/explained_variance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/error.h"

namespace slam::stats {
namespace {

TEST(ExplainedVariance, OfAHandComputedExample) {
  // Means 2, 5 and 8 around 5: between 3 * (9 + 0 + 9) = 54, within 6, in all 60.
  const auto result = explainedVariance({1, 2, 3, 4, 5, 6, 7, 8, 9}, {4, 4, 4, 7, 7, 7, 1, 1, 1});
  EXPECT_NEAR(result.share, 54.0 / 60, 1e-12);
  EXPECT_NEAR(result.adjusted_share, 0.9 - 2 * 0.1 / 6, 1e-12);
  // 6 of the 9! / 3!^3 = 1680 ways to group are as clear: 0.0036; of 2000 within five standard deviations.
  EXPECT_LT(result.p, 0.0036 + 5 * std::sqrt(0.0036 / 2000));
}

TEST(ExplainedVariance, GroupsThatSayNothingExplainNothing) {
  const auto result = explainedVariance({1, 2, 3, 4, 1, 2, 3, 4}, {0, 0, 0, 0, 1, 1, 1, 1});
  EXPECT_DOUBLE_EQ(result.share, 0);
  EXPECT_DOUBLE_EQ(result.adjusted_share, 0);
  EXPECT_DOUBLE_EQ(result.p, 1);
}

TEST(ExplainedVariance, HasNothingToSayOfOneGroupOrOfEqualValues) {
  EXPECT_DOUBLE_EQ(explainedVariance({1, 2, 3}, {5, 5, 5}).p, 1);
  EXPECT_DOUBLE_EQ(explainedVariance({1, 2, 3}, {0, 1, 2}).share, 0);
  EXPECT_DOUBLE_EQ(explainedVariance({2, 2, 2, 2}, {0, 0, 1, 1}).share, 0);
  EXPECT_DOUBLE_EQ(explainedVariance({}, {}).p, 1);
  EXPECT_THROW(explainedVariance({1, 2}, {0}), core::ContractError);
  EXPECT_THROW(explainedVariance({1, INFINITY}, {0, 1}), core::ContractError);
}

TEST(ExplainedVariance, TheSameSeedGivesTheSameP) {
  const std::vector<double> values = {1, 5, 2, 4, 3, 6};
  const std::vector<std::size_t> groups = {0, 1, 0, 1, 0, 1};
  EXPECT_EQ(explainedVariance(values, groups, 3).p, explainedVariance(values, groups, 3).p);
}

}  // namespace
}  // namespace slam::stats
