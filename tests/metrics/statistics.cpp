#include "libslam/metrics/statistics.h"
#include "libslam/core/numbers.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/error.h"

namespace slam::metrics {
namespace {

using core::kNaN;

TEST(Quantile, InterpolatesLinearlyBetweenOrderStatistics) {
  const std::vector<double> values = {40, 10, 30, 20};  // any order
  EXPECT_DOUBLE_EQ(quantile(values, 0), 10);
  EXPECT_DOUBLE_EQ(quantile(values, 0.5), 25);
  EXPECT_DOUBLE_EQ(quantile(values, 0.95), 38.5);  // position 2.85 of 0..3
  EXPECT_DOUBLE_EQ(quantile(values, 1), 40);
  EXPECT_DOUBLE_EQ(quantile({7}, 0.95), 7);
}

TEST(Quantile, IsNaNForNothingAndForNaN) {
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
  EXPECT_TRUE(std::isnan(quantile({1, kNaN, 2}, 0)));
  EXPECT_THROW(quantile({1}, 1.5), core::ContractError);
  EXPECT_THROW(quantile({1}, kNaN), core::ContractError);
}

TEST(ErrorStatistics, SummariseAListComputedByHand) {
  const auto s = errorStatistics({3, 0, 1, 0, 1});
  EXPECT_EQ(s.count, 5U);
  EXPECT_DOUBLE_EQ(s.mean, 1);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(11.0 / 5));
  EXPECT_DOUBLE_EQ(s.median, 1);
  EXPECT_DOUBLE_EQ(s.p95, 1 + 0.8 * 2);  // position 3.8
  EXPECT_DOUBLE_EQ(s.max, 3);
}

TEST(ErrorStatistics, AreAllNaNForNothingAndForAnErrorThatIsNotFinite) {
  for (const auto& errors : {std::vector<double>{}, {1, kNaN}, {1, INFINITY}}) {
    const auto s = errorStatistics(errors);
    EXPECT_EQ(s.count, errors.size());
    for (const double value : {s.mean, s.rmse, s.median, s.p95, s.max}) EXPECT_TRUE(std::isnan(value));
  }
}

}  // namespace
}  // namespace slam::metrics
