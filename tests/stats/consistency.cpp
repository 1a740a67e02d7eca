#include "libslam/stats/consistency.h"
#include "libslam/core/numbers.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/error.h"
#include "libslam/core/random.h"

namespace slam::stats {
namespace {

TEST(NormalizedErrorSquared, IsTheSquareOfErrorOverSigma) {
  Eigen::Matrix3d covariance = Eigen::Vector3d(0.04, 0.09, 1e-4).asDiagonal();
  EXPECT_NEAR(*normalizedErrorSquared(Eigen::Vector3d(0.2, 0.6, 0.03), covariance), 1 + 4 + 9, 1e-12);
  EXPECT_EQ(*normalizedErrorSquared(Eigen::Vector3d::Zero(), covariance), 0);
  // By hand: inverse of [2 1; 1 2] is [2 -1; -1 2] / 3.
  Eigen::Matrix2d correlated;
  correlated << 2, 1, 1, 2;
  EXPECT_NEAR(*normalizedErrorSquared(Eigen::Vector2d(1, 1), correlated), 2.0 / 3, 1e-12);
  EXPECT_NEAR(*normalizedErrorSquared(Eigen::Vector2d(1, -1), correlated), 2, 1e-12);
}

TEST(NormalizedErrorSquared, DoesNotDependOnUnits) {
  Eigen::Matrix2d covariance;
  covariance << 1e-18, 0.5e-9, 0.5e-9, 1;  // one sigma nine orders below the other
  EXPECT_NEAR(*normalizedErrorSquared(Eigen::Vector2d(1e-9, 0), covariance), 4.0 / 3, 1e-9);
}

TEST(NormalizedErrorSquared, IsNothingWhereTheCovarianceClaimsNothing) {
  const Eigen::Vector2d error(1, 1);
  EXPECT_FALSE(normalizedErrorSquared(error, Eigen::Matrix2d::Zero()));
  Eigen::Matrix2d singular, indefinite;
  singular << 1, 1, 1, 1;
  indefinite << 1, 2, 2, 1;
  EXPECT_FALSE(normalizedErrorSquared(error, singular));
  EXPECT_FALSE(normalizedErrorSquared(error, indefinite));
  EXPECT_FALSE(normalizedErrorSquared(error, -Eigen::Matrix2d::Identity()));
  EXPECT_FALSE(normalizedErrorSquared(error, std::nan("") * Eigen::Matrix2d::Identity()));
  EXPECT_FALSE(normalizedErrorSquared(std::nan("") * error, Eigen::Matrix2d::Identity()));
  EXPECT_THROW(normalizedErrorSquared(error, Eigen::Matrix3d::Identity()), core::ContractError);
}

TEST(ChiSquared, HasItsTabledQuantiles) {
  EXPECT_NEAR(chiSquaredQuantile(0.95, 1), 3.8415, 5e-5);
  EXPECT_NEAR(chiSquaredQuantile(0.95, 3), 7.8147, 5e-5);
  EXPECT_NEAR(chiSquaredQuantile(0.5, 3), 2.3660, 5e-5);
  EXPECT_NEAR(chiSquaredQuantile(0.5, 2), 2 * std::log(2.0), 1e-12);
  EXPECT_THROW(chiSquaredQuantile(1, 3), core::ContractError);
  EXPECT_THROW(chiSquaredQuantile(0.5, 0), core::ContractError);
}

TEST(Consistency, OfTrueCovariancesIsOne) {
  core::RandomStream random(3, "nees");
  std::vector<std::vector<double>> runs(50);
  for (auto& run : runs)
    for (int i = 0; i < 100; ++i) {
      double nees = 0;
      for (int k = 0; k < 3; ++k) nees += std::pow(random.normal(), 2);
      run.push_back(nees);
    }
  const auto result = consistency(runs, 3);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->runs, 50U);
  EXPECT_EQ(result->samples, 5000U);
  // Three standard errors of 5000 samples: sqrt(2/3/5000) = 0.012, 0.007 and 0.003.
  EXPECT_NEAR(result->anees.value, 1, 0.035);
  EXPECT_NEAR(result->coverage50.value, 0.5, 0.021);
  EXPECT_NEAR(result->coverage95.value, 0.95, 0.01);
  // Independent errors: the interval over runs is as wide as one over samples, 2 * 1.96 * 0.0115, give or
  // take what the spread of 50 runs says.
  EXPECT_NEAR(result->anees.interval->high - result->anees.interval->low, 0.045, 0.012);
}

TEST(Consistency, CountsRunsAndNotScans) {
  // All errors of a run are the same: 1000 scans know no more than one of each run does.
  std::vector<std::vector<double>> runs, one_each;
  for (int run = 0; run < 8; ++run) {
    runs.emplace_back(1000, 1.0 + run);
    one_each.push_back({1.0 + run});
  }
  const auto long_runs = consistency(runs, 3), short_runs = consistency(one_each, 3);
  EXPECT_DOUBLE_EQ(long_runs->anees.value, 4.5 / 3);
  EXPECT_NEAR(long_runs->anees.interval->low, short_runs->anees.interval->low, 1e-9);
  EXPECT_NEAR(long_runs->anees.interval->high, short_runs->anees.interval->high, 1e-9);
  EXPECT_EQ(long_runs->coverage50.value, 2.0 / 8);  // 1 and 2 are below 2.366
  EXPECT_EQ(long_runs->coverage95.value, 7.0 / 8);  // 8 is above 7.815
}

TEST(Consistency, HasNoIntervalForOneRunAndNoFiguresForNone) {
  const auto one = consistency({{1, 2}, {}}, 3);
  EXPECT_EQ(one->runs, 1U);
  EXPECT_DOUBLE_EQ(one->anees.value, 0.5);
  EXPECT_FALSE(one->anees.interval);
  EXPECT_FALSE(consistency({{}, {}}, 3));
  EXPECT_FALSE(consistency({}, 3));
  EXPECT_THROW(consistency({{-1}}, 3), core::ContractError);
  EXPECT_THROW(consistency({{std::nan("")}}, 3), core::ContractError);
}

TEST(Consistency, ClaimedCertaintiesLieOutsideOfEveryEllipse) {
  using core::kInfinity;
  const auto half = consistency({{1, kInfinity}, {kInfinity, 5}}, 3);
  EXPECT_DOUBLE_EQ(half->anees.value, 1);  // of 1 and 5 over 3
  EXPECT_DOUBLE_EQ(half->singular_share, 0.5);
  EXPECT_DOUBLE_EQ(half->coverage50.value, 0.25);
  EXPECT_DOUBLE_EQ(half->coverage95.value, 0.5);
  const auto all = consistency({{kInfinity}}, 3);
  EXPECT_TRUE(std::isnan(all->anees.value));
  EXPECT_EQ(all->singular_share, 1);
  EXPECT_EQ(all->coverage95.value, 0);
  EXPECT_EQ(consistency({{1, 2}}, 3)->singular_share, 0);
}

}  // namespace
}  // namespace slam::stats
