#include "libslam/stats/mean_interval.h"
#include "libslam/core/numbers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "libslam/core/error.h"
#include "libslam/core/random.h"

namespace slam::stats {
namespace {

using core::kInfinity;
using core::kNaN;

MeanOptions errors() {
  MeanOptions options;
  options.lowest = 0;
  return options;
}

MeanOptions shares() {
  MeanOptions options = errors();
  options.highest = 1;
  return options;
}

TEST(MeanInterval, OfSymmetricValuesIsStudents) {
  // By hand: mean 3, standard deviation sqrt(2.5), 4 degrees of freedom: t = 2.776445.
  const auto estimate = meanInterval({1, 2, 3, 4, 5});
  const double half_width = 2.776445 * std::sqrt(2.5 / 5);
  EXPECT_DOUBLE_EQ(estimate.value, 3);
  EXPECT_NEAR(estimate.interval->low, 3 - half_width, 1e-6);
  EXPECT_NEAR(estimate.interval->high, 3 + half_width, 1e-6);
  // The same of logarithms where nothing lies below 0, and of logits between 0 and 6.
  const auto above_zero = meanInterval({1, 2, 3, 4, 5}, errors());
  EXPECT_NEAR(above_zero.interval->low, 3 * std::exp(-half_width / 3), 1e-6);
  EXPECT_NEAR(above_zero.interval->high, 3 * std::exp(half_width / 3), 1e-6);
  MeanOptions to_six = shares();
  to_six.highest = 6;
  const auto between = meanInterval({1, 2, 3, 4, 5}, to_six);
  const double odds = std::exp(half_width * 6 / (3 * 3));
  EXPECT_NEAR(between.interval->low, std::min(3 - half_width, 6 / (1 + odds)), 1e-6);
  EXPECT_NEAR(between.interval->high, std::max(3 + half_width, 6 - 6 / (1 + odds)), 1e-6);
}

TEST(MeanInterval, IsMirroredWithTheValues) {
  const std::vector<double> values = {0.1, 0.2, 0.25, 0.9, 0.95};
  std::vector<double> mirrored;
  mirrored.reserve(values.size());
  for (const double value : values) mirrored.push_back(1 - value);
  for (const auto& options : {MeanOptions(), shares()}) {
    const auto estimate = meanInterval(values, options), opposite = meanInterval(mirrored, options);
    EXPECT_NEAR(estimate.interval->low, 1 - opposite.interval->high, 1e-12);
    EXPECT_NEAR(estimate.interval->high, 1 - opposite.interval->low, 1e-12);
  }
}

TEST(MeanInterval, LeansTowardsTheLongTailAndKeepsItsBounds) {
  const auto estimate = meanInterval({0.1, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.9, 1.7, 6}, errors());
  EXPECT_GT(estimate.interval->high - estimate.value, 2 * (estimate.value - estimate.interval->low));
  EXPECT_GT(estimate.interval->low, 0);
  const auto share = meanInterval({1, 1, 1, 0.9, 1}, shares());
  EXPECT_LE(share.interval->high, 1);
  EXPECT_GE(meanInterval({0, 0, 0, 0, 1}, shares()).interval->low, 0);
}

TEST(MeanInterval, IsNoneForOneValueAndEmptyForEqualOnes) {
  EXPECT_EQ(meanInterval({3}).value, 3);
  EXPECT_FALSE(meanInterval({3}).interval);
  for (const auto& options : {MeanOptions(), errors(), shares()}) {
    const auto equal = meanInterval({0, 0, 0}, options);
    EXPECT_EQ(equal.interval->low, 0);
    EXPECT_EQ(equal.interval->high, 0);
  }
}

TEST(MeanInterval, OfStrataCountsWhatVariesWithinThem) {
  // 0 and 2, 10 and 10: variance of the sum 2 * 2, of the mean 4 / 16; one degree of freedom: t = 12.7062.
  MeanOptions options;
  options.strata = {4, 9, 4, 9};
  const auto estimate = meanInterval({0, 10, 2, 10}, options);
  EXPECT_DOUBLE_EQ(estimate.value, 5.5);
  EXPECT_NEAR(estimate.interval->high, 5.5 + 12.7062 / 2, 1e-4);
  // Two strata alike: both count, with two degrees of freedom (t = 4.30265).
  const auto both = meanInterval({0, 10, 2, 12}, options);
  EXPECT_NEAR(both.interval->high, 6 + 4.30265 * std::sqrt(8) / 4, 1e-4);
  // A stratum of one value varies as the others do.
  options.strata = {4, 9, 4, 9, 1};
  const auto with_single = meanInterval({0, 10, 2, 12, 40}, options);
  EXPECT_NEAR(with_single.interval->high, 64.0 / 5 + 4.30265 * std::sqrt(10) / 5, 1e-4);
  options.strata = {1, 2, 3};
  EXPECT_FALSE(meanInterval({1, 2, 3}, options).interval);
}

TEST(MeanInterval, OneStratumIsNone) {
  MeanOptions one = errors();
  one.strata = {3, 3, 3, 3};
  const auto with = meanInterval({0.1, 0.7, 0.2, 1.9}, one),
             without = meanInterval({0.1, 0.7, 0.2, 1.9}, errors());
  EXPECT_EQ(with.interval->low, without.interval->low);
  EXPECT_EQ(with.interval->high, without.interval->high);
}

TEST(RatioInterval, OfEqualWholesIsThatOfTheMean) {
  const std::vector<double> values = {0.1, 0.7, 0.2, 1.9};
  const auto ratio = ratioInterval({1, 7, 2, 19}, {10, 10, 10, 10}, errors());
  const auto mean_of = meanInterval(values, errors());
  EXPECT_NEAR(ratio.value, mean_of.value, 1e-12);
  EXPECT_NEAR(ratio.interval->low, mean_of.interval->low, 1e-12);
  EXPECT_NEAR(ratio.interval->high, mean_of.interval->high, 1e-12);
  // Units of one ratio have no spread, however large each is.
  const auto same = ratioInterval({1, 2, 30}, {10, 20, 300}, errors());
  EXPECT_NEAR(same.interval->low, 0.1, 1e-9);
  EXPECT_NEAR(same.interval->high, 0.1, 1e-9);
}

// What the header says of small samples: a measurement, not a wish.
TEST(MeanInterval, HoldsTheTrueMeanAsOftenAsItSaysAlsoOfFewAndSkewedValues) {
  struct Kind {
    const char* name;
    double true_mean;
    std::function<double(core::RandomStream&)> draw;
    double at_5, at_10;
  };
  const auto logNormal = [](double sigma) {
    return [sigma](core::RandomStream& random) { return std::exp(sigma * random.normal()); };
  };
  const std::vector<Kind> kinds = {
      {"normal", 1, [](core::RandomStream& random) { return std::max(0.0, 1 + 0.2 * random.normal()); }, 0.95,
       0.95},
      {"chi-squared", 1,
       [](core::RandomStream& random) {
         double sum = 0;
         for (int i = 0; i < 3; ++i) sum += std::pow(random.normal(), 2);
         return sum / 3;
       },
       0.95, 0.94},
      {"exponential", 1, [](core::RandomStream& random) { return -std::log(1 - random.uniform()); }, 0.94,
       0.94},
      {"log-normal 0.6", std::exp(0.18), logNormal(0.6), 0.94, 0.94},
      {"log-normal 1", std::exp(0.5), logNormal(1), 0.91, 0.90},
  };
  const auto coverage = [](const Kind& kind, int count) {
    constexpr int kTrials = 4000;
    core::RandomStream random(7, kind.name);
    int covered = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
      std::vector<double> values;
      values.reserve(static_cast<std::size_t>(count));
      for (int i = 0; i < count; ++i) values.push_back(kind.draw(random));
      const auto interval = meanInterval(values, errors()).interval;
      covered += interval->low <= kind.true_mean && interval->high >= kind.true_mean ? 1 : 0;
    }
    return static_cast<double>(covered) / kTrials;
  };
  // Three standard errors of 4000 trials: 0.011 to 0.014.
  for (const auto& kind : kinds) {
    EXPECT_NEAR(coverage(kind, 5), kind.at_5, 0.015) << kind.name;
    EXPECT_NEAR(coverage(kind, 10), kind.at_10, 0.015) << kind.name;
  }
}

TEST(MeanInterval, RefusesWhatHasNone) {
  EXPECT_THROW(meanInterval({}), core::ContractError);
  EXPECT_THROW(meanInterval({1, kNaN}), core::ContractError);
  EXPECT_THROW(meanInterval({1, kInfinity}), core::ContractError);
  EXPECT_THROW(meanInterval({1, -1}, errors()), core::ContractError);
  EXPECT_THROW(meanInterval({0.5, 1.5}, shares()), core::ContractError);
  MeanOptions options;
  options.confidence = 1;
  EXPECT_THROW(meanInterval({1, 2}, options), core::ContractError);
  options = {};
  options.strata = {1};
  EXPECT_THROW(meanInterval({1, 2}, options), core::ContractError);
  options = {};
  options.highest = 3;
  EXPECT_THROW(meanInterval({1, 2}, options), core::ContractError);
  EXPECT_THROW(ratioInterval({1}, {1, 2}), core::ContractError);
  EXPECT_THROW(ratioInterval({1, 2}, {0, 0}), core::ContractError);
  EXPECT_THROW(ratioInterval({1, 2}, {1, -1}), core::ContractError);
}

}  // namespace
}  // namespace slam::stats
