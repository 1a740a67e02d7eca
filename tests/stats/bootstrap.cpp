#include "libslam/stats/bootstrap.h"
#include "libslam/core/numbers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/stats/paired.h"

namespace slam::stats {
namespace {

using core::kInfinity;
using core::kNaN;

// Test A of 26 neurologically impaired children: Efron and Tibshirani, An Introduction to the Bootstrap,
// 1993, table 14.1.
const std::vector<double> kSpatialTest = {48, 36, 20, 29, 42, 42, 20, 42, 22, 41, 45, 14, 6,
                                          0,  33, 28, 34, 4,  32, 24, 47, 41, 24, 26, 30, 41};

double variance(const std::vector<double>& values, const std::vector<std::size_t>& indices) {
  double sum = 0, squares = 0;
  for (const auto i : indices) sum += values[i], squares += values[i] * values[i];
  const auto n = static_cast<double>(indices.size());
  return squares / n - sum / n * (sum / n);
}

TEST(Bootstrap, GivesEfronAndTibshiranisIntervalOfAVariance) {
  const IndexStatistic statistic = [](const auto& indices) { return variance(kSpatialTest, indices); };
  BootstrapOptions options;
  options.confidence = 0.9;
  const auto estimate = bootstrapInterval(kSpatialTest.size(), statistic, options);
  EXPECT_NEAR(estimate.value, 171.5, 0.05);
  // Their table 14.2, from 2000 resamples: (115.8, 259.6), the percentile interval (100.8, 233.9). A 5 %
  // point of 2000 resamples has a standard error of some 2 below and 4 above.
  ASSERT_TRUE(estimate.interval);
  EXPECT_NEAR(estimate.interval->low, 115.8, 4);
  EXPECT_NEAR(estimate.interval->high, 259.6, 8);
}

TEST(Bootstrap, OfTheMedianStaysWithinTheValues) {
  const std::vector<double> values = {1, 2, 3, 5, 8, 13, 21};
  const auto estimate = bootstrapMedian(values);
  EXPECT_EQ(estimate.value, 5);
  EXPECT_EQ(estimate.interval->low, 2);  // binomial: the 2nd value bounds a 95 % interval of 7
  EXPECT_EQ(estimate.interval->high, 13);
}

TEST(Bootstrap, IsMirroredWithTheValues) {
  const std::vector<double> values = {0.1, 0.2, 0.25, 0.9, 1.7, 6};
  std::vector<double> mirrored;
  mirrored.reserve(values.size());
  for (const double value : values) mirrored.push_back(-value);
  const auto estimate = bootstrapMedian(values), opposite = bootstrapMedian(mirrored);
  // The same resamples: only the rounding of sums differs.
  EXPECT_NEAR(estimate.interval->low, -opposite.interval->high, 1e-9);
  EXPECT_NEAR(estimate.interval->high, -opposite.interval->low, 1e-9);
}

TEST(Bootstrap, SaysTheSameForTheSameSeedOnly) {
  const IndexStatistic statistic = [](const auto& indices) { return variance(kSpatialTest, indices); };
  BootstrapOptions options;
  options.resamples = 200;
  const auto first = bootstrapInterval(kSpatialTest.size(), statistic, options);
  EXPECT_EQ(first.interval->high, bootstrapInterval(kSpatialTest.size(), statistic, options).interval->high);
  options.seed = 2;
  EXPECT_NE(first.interval->high, bootstrapInterval(kSpatialTest.size(), statistic, options).interval->high);
}

TEST(Bootstrap, HasNoIntervalForOneValueAndAnEmptyOneForEqualValues) {
  const auto single = bootstrapMedian({3});
  EXPECT_EQ(single.value, 3);
  EXPECT_FALSE(single.interval);
  const auto equal = bootstrapMedian({3, 3, 3});
  EXPECT_EQ(equal.interval->low, 3);
  EXPECT_EQ(equal.interval->high, 3);
}

TEST(Bootstrap, FallsBackToPercentilesWhereNoResampleLiesBelow) {
  // The smallest value: no resample has a smaller one, so the share below it says nothing once ties are few.
  const std::vector<double> values = {1, 2, 3, 4, 5, 6};
  const IndexStatistic never_below = [&](const auto& indices) {
    return std::is_sorted(indices.begin(), indices.end()) && indices.front() != indices.back()
               ? 0.0
               : 1 + values[indices.front()];
  };
  BootstrapOptions few;
  few.resamples = 100;  // a sorted one among them is unlikely, and this seed has none
  const auto estimate = bootstrapInterval(values.size(), never_below, few);
  EXPECT_EQ(estimate.value, 0);
  EXPECT_EQ(estimate.interval->low, 2);
  EXPECT_EQ(estimate.interval->high, 7);
}

TEST(Bootstrap, OfTheMedianTakesFailedRuns) {
  const auto few = bootstrapMedian({1, 2, 3, 4, 5, 6, kInfinity});
  EXPECT_EQ(few.value, 4);
  EXPECT_EQ(few.interval->low, 2);
  EXPECT_EQ(few.interval->high, 6);
  const auto most = bootstrapMedian({1, 2, kInfinity, kInfinity, kInfinity});
  EXPECT_EQ(most.value, kInfinity);
  EXPECT_EQ(most.interval->high, kInfinity);
  EXPECT_EQ(median({-kInfinity, 2}), -kInfinity);
}

TEST(Bootstrap, TheMedianByCountingIsTheMedian) {
  core::RandomStream random(5, "median");
  for (std::size_t count = 2; count < 60; ++count) {
    std::vector<double> values;
    values.reserve(count);
    // Many ties; a third of them failed.
    for (std::size_t i = 0; i < count; ++i)
      values.push_back(random.below(3) == 0 ? failedValue(Better::kSmaller)
                                            : static_cast<double>(random.below(9)));
    EXPECT_EQ(bootstrapMedian(values, {0.95, 1, 100}).value, median(values)) << count;
  }
}

TEST(Bootstrap, RefusesWhatHasNoStatistic) {
  EXPECT_THROW(bootstrapMedian({}), core::ContractError);
  EXPECT_THROW(bootstrapMedian({1, kNaN}), core::ContractError);
  EXPECT_THROW(median({kInfinity, -kInfinity}), core::ContractError);
  EXPECT_THROW(bootstrapMedian({1, 2}, {1.0, 1, 1000}), core::ContractError);
  EXPECT_THROW(bootstrapMedian({1, 2}, {0.95, 1, 99}), core::ContractError);
  EXPECT_THROW(bootstrapInterval(2, [](const auto&) { return kNaN; }), core::ContractError);
}

TEST(Bootstrap, DrawsWithinStrata) {
  const std::vector<double> values = {0, 10, 2, 10};
  const IndexStatistic mean_of_drawn = [&](const auto& indices) {
    double sum = 0;
    for (const auto i : indices) sum += values[i];
    return sum / static_cast<double>(indices.size());
  };
  // Of 0 and 2 a resample has the sum 0, 2 or 4, with 1/4, 1/2, 1/4; of 10 and 10 always 20.
  const auto estimate = bootstrapInterval(4, mean_of_drawn, {0.95, 1, 2000, {4, 9, 4, 9}});
  EXPECT_DOUBLE_EQ(estimate.value, 5.5);
  EXPECT_DOUBLE_EQ(estimate.interval->low, 5);
  EXPECT_DOUBLE_EQ(estimate.interval->high, 6);
  const auto pooled = bootstrapInterval(4, mean_of_drawn, {0.95, 1, 2000});
  EXPECT_LT(pooled.interval->low, 3);
  EXPECT_GT(pooled.interval->high, 7);
  // What varies between strata only is no spread.
  const auto between = bootstrapMedian({1, 1, 5, 5, 5}, {0.95, 1, 200, {0, 0, 1, 1, 1}});
  EXPECT_EQ(between.interval->low, 5);
  EXPECT_EQ(between.interval->high, 5);
  EXPECT_FALSE(bootstrapMedian({1, 2, 3}, {0.95, 1, 200, {0, 1, 2}}).interval);
  EXPECT_THROW(bootstrapMedian({1, 2, 3}, {0.95, 1, 200, {0, 1}}), core::ContractError);
}

TEST(Bootstrap, OneStratumIsNone) {
  const std::vector<double> values = {0.1, 0.7, 0.2, 1.9, 0.4};
  const auto none = bootstrapMedian(values, {0.95, 1, 500});
  const auto one = bootstrapMedian(values, {0.95, 1, 500, {3, 3, 3, 3, 3}});
  EXPECT_EQ(none.interval->low, one.interval->low);
  EXPECT_EQ(none.interval->high, one.interval->high);
}

TEST(Median, IsTheMiddleOrBetweenTheTwo) {
  EXPECT_EQ(median({5, 1, 3}), 3);
  EXPECT_EQ(median({5, 1, 3, 4}), 3.5);
  EXPECT_EQ(median({2}), 2);
  EXPECT_THROW(median({}), core::ContractError);
  EXPECT_THROW(median({1, kNaN}), core::ContractError);
}

}  // namespace
}  // namespace slam::stats
